//! The words of the language, sorted into the kinds that a grammar colours.

use g7_model::words::{self, PLACES, Word};
use g7_model::{ProfileName, Qualifier, StandardFunction, TargetPlc, Type};

/// The words by kind, each once. Words of IEC 61131-3 stand there in small letters and in capitals.
#[derive(Debug)]
pub struct Vocabulary {
    /// Words that are never names, operators and constants aside.
    pub reserved: Vec<String>,
    /// Words that begin something and are names elsewhere.
    pub begins: Vec<String>,
    /// Words that go on with something and are names elsewhere.
    pub clauses: Vec<String>,
    /// `and`, `not`, …
    pub operators: Vec<String>,
    /// `TRUE`, `false`, …
    pub constants: Vec<String>,
    /// `rise`, `fall`, `delay`.
    pub edges: Vec<String>,
    /// Qualifiers, the longer ones first.
    pub qualifiers: Vec<String>,
    /// Types and function blocks, the longer ones first.
    pub types: Vec<String>,
    /// Standard functions.
    pub functions: Vec<String>,
    /// Profiles.
    pub profiles: Vec<String>,
    /// Switches of profiles, the longer ones first.
    pub switches: Vec<String>,
    /// PLCs whose limits are known.
    pub targets: Vec<String>,
    /// Each word of the table as it stands there, members aside.
    pub keywords: Vec<String>,
}

impl Vocabulary {
    /// The words of the table.
    pub fn new() -> Vocabulary {
        let operators = spellings(words::OPERATOR.iter());
        let constants = spellings(words::VALUE.iter().filter(|w| w.capitals));
        let edges = spellings(words::VALUE.iter().filter(|w| !w.capitals));
        let mut reserved = words::reserved();
        reserved.retain(|w| ![&operators, &constants, &edges].iter().any(|list| list.contains(w)));
        let free = |list: &'static [Word]| list.iter().filter(|w| !w.reserved);
        let lists = [words::FILE, words::CHART, words::ACTION, words::PLANT, words::TEST, words::LAYOUT];
        let members = [words::STEP, words::PART];
        let keywords = PLACES.iter().filter(|(_, list)| !members.contains(list));
        let texts = |all: Vec<&'static str>| sorted(all.into_iter().map(str::to_owned).collect());
        let mut functions: Vec<&str> = StandardFunction::ALL.iter().map(|f| f.row().name).collect();
        functions.retain(|name| !name.is_empty());
        Vocabulary {
            reserved,
            begins: spellings(lists.into_iter().flat_map(free)),
            clauses: spellings(free(words::CLAUSES)),
            operators,
            constants,
            edges,
            qualifiers: long_first(Qualifier::ALL.map(Qualifier::name).into()),
            types: long_first(
                Type::names().chain(Type::OTHER_NAMES.map(|(name, _)| name)).chain(["ARRAY"]).collect(),
            ),
            functions: texts(functions),
            profiles: texts(ProfileName::ALL.map(ProfileName::name).into()),
            switches: long_first(g7_syntax::SWITCHES.map(|(name, _)| name).into()),
            targets: texts(TargetPlc::ALL.map(TargetPlc::name).into()),
            keywords: texts(keywords.flat_map(|(_, list)| words::texts(list)).collect()),
        }
    }
}

impl Default for Vocabulary {
    fn default() -> Vocabulary {
        Vocabulary::new()
    }
}

fn spellings<'w>(list: impl Iterator<Item = &'w Word>) -> Vec<String> {
    let mut found = Vec::new();
    for word in list {
        found.push(word.text.to_owned());
        if word.capitals {
            found.push(word.text.to_ascii_uppercase());
        }
    }
    sorted(found)
}

fn sorted(mut list: Vec<String>) -> Vec<String> {
    list.sort();
    list.dedup();
    list
}

/// For alternatives of regular expressions, which take the first that fits.
fn long_first(list: Vec<&str>) -> Vec<String> {
    let mut list = sorted(list.into_iter().map(str::to_owned).collect());
    list.sort_by_key(|w| std::cmp::Reverse(w.len()));
    list
}
