//! An exercise, read from the files of its folder.
//!
//! ```text
//! statement.md  hints.md        texts, also .fr.md and .pt.md
//! template.g7                   what the student gets: declarations, locked parts, plant, the tests that the student sees
//! model.g7                      the model solution, with the tests that the student does not see
//! wrong/*.g7                    wrong solutions; each must fail a test or break a question
//! ```
//!
//! Mistakes of the exercise are [`Fault`]s, each with its place; an exercise with one of them grades nobody.

use std::collections::BTreeSet;
use std::sync::Arc;

use g7_model::{Document, Item, Language, Problem, Said, Severity, Span, say};
use g7_rig::{Source, testing};

use crate::locked::{self, Locked};
use crate::needs::{self, Need};
use crate::sealed;
use crate::texts::{Files, Texts, file_name};

/// The file that the student gets.
pub const TEMPLATE: &str = "template.g7";
/// The file of the model solution.
pub const MODEL: &str = "model.g7";
/// The folder of the wrong solutions, as their paths begin.
pub const WRONG: &str = "wrong/";

/// The file numbers of the template and the model solution. A submission and the files that it uses have smaller ones.
const TEMPLATE_ID: u32 = 0x4000_0000;
const MODEL_ID: u32 = 0x6000_0000;

/// A mistake of the exercise, for its teacher.
#[derive(Clone, Debug)]
pub struct Fault {
    /// A path, or `path:line:column`.
    pub place: String,
    /// The sentence.
    pub what: Said,
}

/// An exercise that can grade.
#[derive(Debug)]
pub struct Exercise {
    /// The statement.
    pub statement: Texts,
    /// The hints, in steps.
    pub hints: Texts,
    /// The file that the student gets.
    pub template: Arc<Source>,
    /// The model solution.
    pub model: Arc<Source>,
    /// The wrong solutions by their paths in the folder.
    pub wrong: Files,
    pub(crate) locked: Vec<Locked>,
    pub(crate) needs: Vec<Need>,
    /// Plants, tests and properties, each with the file in which it stands.
    pub(crate) asked: Vec<(Arc<Source>, Vec<Item>)>,
    /// Files that the template uses, which each submission may use.
    given: Files,
}

impl Exercise {
    /// Reads the exercise of a folder. `name` is the folder in messages.
    ///
    /// # Errors
    ///
    /// Its mistakes, as far as they show without grading the model solution ([`check`](crate::check)).
    pub fn read(files: &Files, name: &str) -> Result<Exercise, Vec<Fault>> {
        let shown = |path: &str| if name.is_empty() { path.to_owned() } else { format!("{name}/{path}") };
        let mut faults = Vec::new();
        let mut fault = |place: String, what: Said| faults.push(Fault { place, what });
        let (statement, hints) = (Texts::of(files, "statement"), Texts::of(files, "hints"));
        if statement.own(Language::English).is_none() {
            fault(shown("statement.md"), say!("an exercise has a statement in this file"));
        }
        for (language, own, english) in hints.uneven() {
            let what = say!("hints here: {own}; in English: {english}");
            fault(shown(&file_name("hints", language)), what);
        }
        let mut read = |path: &str, id: u32| {
            let Some(bytes) = files.get(path) else {
                let what = match path {
                    TEMPLATE => say!("an exercise has a file with this name: what the student gets"),
                    _ => say!("an exercise has a file with this name: the model solution"),
                };
                fault(shown(path), what);
                return None;
            };
            Some(linked(Source::native(&shown(path), bytes.clone(), id), files))
        };
        let (template, model) = (read(TEMPLATE, TEMPLATE_ID), read(MODEL, MODEL_ID));
        let (Some(template), Some(model)) = (template, model) else { return Err(faults) };
        faults.extend(faulty(&template));
        faults.extend(errors(model.read_problems()).iter().map(|p| problem(&model, p)));
        let (locked, idle) = locked::locked(&template);
        faults.extend(idle.into_iter().map(|at| Fault {
            place: template.place(at),
            what: say!(
                "this note locks nothing: it stands before a part of the file, without an empty line between"
            ),
        }));
        let (hidden, differing) = hidden(&template.document, &model.document);
        faults.extend(differing.into_iter().map(|at| Fault {
            place: model.place(at),
            what: say!(
                "the template has this too, and not the same: the student would see another one than the one that counts"
            ),
        }));
        let (template, model) = (Arc::new(template), Arc::new(model));
        let asked = asked(&template, &model, hidden);
        if !asked.iter().any(|(_, items)| items.iter().any(|i| matches!(i, Item::Test(_)))) {
            let what = say!("the exercise has no test, so that nothing could be graded");
            faults.push(Fault { place: shown(TEMPLATE), what });
        }
        if !faults.is_empty() {
            return Err(faults);
        }
        let wrong = files.iter().filter(|(path, _)| path.starts_with(WRONG) && path.ends_with(".g7"));
        let wrong = wrong.map(|(path, bytes)| (path.clone(), bytes.clone())).collect();
        let needs = needs::needs(&template, &model, &asked);
        let given = given(&template);
        Ok(Exercise { statement, hints, template, model, wrong, locked, needs, asked, given })
    }

    /// All that a student's own program needs besides the template, not to be read by chance ([`Exercise::handed`]).
    pub fn sealed(&self) -> String {
        let hidden = self.asked.iter().filter(|(source, _)| source.id() == self.model.id());
        let texts = hidden.flat_map(|(source, items)| items.iter().map(|i| source.written(i.at())));
        let needs: Vec<String> = self.needs.iter().map(Need::line).collect();
        sealed::seal(&needs, &texts.collect::<Vec<_>>())
    }

    /// The exercise as a student's own program has it: the template, the files that it uses, and what
    /// [`Exercise::sealed`] gave. It grades as the whole exercise does, and has neither solutions nor texts.
    ///
    /// # Errors
    ///
    /// The sealed part is damaged.
    pub fn handed(template: &[u8], others: &Files, sealed: &str) -> Result<Exercise, Said> {
        let damaged = || say!("the hidden part of this exercise is damaged");
        let (needs, hidden) = sealed::open(sealed).ok_or_else(damaged)?;
        let needs: Option<Vec<Need>> = needs.iter().map(|line| Need::of_line(line, MODEL)).collect();
        let template = linked(Source::native(TEMPLATE, template.to_vec(), TEMPLATE_ID), others);
        let model = Source::native(MODEL, hidden.into_bytes(), MODEL_ID);
        let (locked, _) = locked::locked(&template);
        let hidden = model.document.items.iter().filter(|i| locked::is_of_the_exercise(i)).cloned().collect();
        let (template, model) = (Arc::new(template), Arc::new(model));
        Ok(Exercise {
            statement: Texts::default(),
            hints: Texts::default(),
            wrong: Files::new(),
            locked,
            needs: needs.ok_or_else(damaged)?,
            asked: asked(&template, &model, hidden),
            given: given(&template),
            template,
            model,
        })
    }

    /// The files that the template uses, which each submission may use.
    pub fn given(&self) -> &Files {
        &self.given
    }

    /// Reads the charts of a submission, or of a solution. `read` has the files that it brings along; those that the template
    /// uses are there as well.
    pub fn submission(
        &self,
        name: &str,
        bytes: Vec<u8>,
        read: &mut dyn FnMut(&str) -> Result<Vec<u8>, Said>,
    ) -> Source {
        let mut source = Source::new(name, bytes, 0);
        source.link(&mut |path| self.given.get(path).cloned().map_or_else(|| read(path), Ok));
        source
    }

    /// The titles of the tests, those that the student sees first; each with `true` for a hidden one.
    pub fn tests(&self) -> impl Iterator<Item = (&str, bool)> {
        self.asked.iter().zip([false, true]).flat_map(|((_, items), hidden)| {
            items
                .iter()
                .filter_map(move |i| if let Item::Test(t) = i { Some((&*t.title, hidden)) } else { None })
        })
    }
}

/// A file of the exercise with those that it uses.
fn linked(mut source: Source, files: &Files) -> Source {
    source.link(&mut |used| files.get(used).cloned().ok_or_else(|| say!("there is no such file")));
    source
}

/// The files that a template uses, apart from the library.
fn given(template: &Source) -> Files {
    let own = template.others().iter().filter(|o| !o.library);
    own.map(|o| (o.path.clone(), o.source.bytes.clone())).collect()
}

/// Everything that is asked of a submission: by the template, and hidden.
fn asked(template: &Arc<Source>, model: &Arc<Source>, hidden: Vec<Item>) -> Vec<(Arc<Source>, Vec<Item>)> {
    let seen = template.document.items.iter().filter(|i| locked::is_of_the_exercise(i)).cloned().collect();
    vec![(Arc::clone(template), seen), (Arc::clone(model), hidden)]
}

/// The errors among some problems.
pub(crate) fn errors(mut problems: Vec<Problem>) -> Vec<Problem> {
    problems.retain(|p| p.severity() == Severity::Error);
    problems
}

/// The errors of the charts, plants, tests and properties of a file.
fn faulty(source: &Source) -> Vec<Fault> {
    let mut problems = source.read_problems();
    if !source.is_broken() {
        match testing::problems(source, None) {
            Ok(found) => problems.extend(found),
            Err(why) => return vec![Fault { place: source.name.clone(), what: why.said() }],
        }
    }
    problems = errors(problems);
    problems.dedup();
    problems.iter().map(|p| problem(source, p)).collect()
}

/// A problem of a file as a mistake of the exercise.
pub(crate) fn problem(source: &Source, problem: &Problem) -> Fault {
    Fault { place: source.place(problem.at), what: problem.what.clone() }
}

/// The plants, tests and properties of the model solution that the template does not have, and the places of those that
/// it has in another form.
fn hidden(template: &Document, model: &Document) -> (Vec<Item>, Vec<Span>) {
    let (mut hidden, mut differing) = (Vec::new(), Vec::new());
    let named: BTreeSet<(u8, &str)> = template.items.iter().filter_map(name).collect();
    for item in model.items.iter().filter(|i| locked::is_of_the_exercise(i)) {
        if template.items.contains(item) {
            continue;
        }
        match name(item) {
            Some(name) if named.contains(&name) => differing.push(item.at()),
            _ => hidden.push(item.clone()),
        }
    }
    (hidden, differing)
}

/// The name by which a plant or a test of the template is known in the model solution.
fn name(item: &Item) -> Option<(u8, &str)> {
    match item {
        Item::Plant(p) => Some((0, &p.name.text)),
        Item::Test(t) => Some((1, &t.title)),
        _ => None,
    }
}
