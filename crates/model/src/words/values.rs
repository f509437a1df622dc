//! The words of expressions, and what the words of other tables do: qualifiers, types, profiles, switches.

use super::row::{Told, Word};
use crate::{FbKind, Moment, Qualifier, Switch, Type};

/// Operators that are words.
pub const OPERATOR: &[Word] = &[
    Word::of_iec(
        "not",
        ["true if the operand is false", "vrai si l’opérande est faux", "verdade se o operando é falso"],
    ),
    Word::of_iec("and", ["both hold", "les deux sont vrais", "ambos são verdade"]),
    Word::of_iec("or", ["one holds, or both", "l’un est vrai, ou les deux", "um é verdade, ou ambos"]),
    Word::of_iec("xor", ["exactly one holds", "un seul est vrai", "só um é verdade"]),
    Word::of_iec("mod", ["the remainder of a division", "le reste d’une division", "o resto de uma divisão"]),
];

/// Reserved words of expressions that are no operators.
pub const VALUE: &[Word] = &[
    Word::of_iec("true", ["true", "vrai", "verdadeiro"]),
    Word::of_iec("false", ["false", "faux", "falso"]),
    Word::reserved("rise", ["a rising edge, ↑", "un front montant, ↑", "um flanco ascendente, ↑"]),
    Word::reserved("fall", ["a falling edge, ↓", "un front descendant, ↓", "um flanco descendente, ↓"]),
    Word::reserved(
        "delay",
        [
            "true some time after a condition, t1/a/t2",
            "vrai un temps après une condition, t1/a/t2",
            "verdade um tempo depois de uma condição, t1/a/t2",
        ],
    ),
];

/// Members of a step.
pub const STEP: &[Word] = &[
    Word::free("X", ["active or not", "active ou non", "ativa ou não"]),
    Word::free("T", ["time since activation", "temps depuis l’activation", "tempo desde a ativação"]),
];

/// Words of a type, besides the names of types.
pub const TYPE: &[Word] = &[Word {
    text: "array",
    then: "[1..2] OF ",
    reserved: false,
    capitals: true,
    does: [
        "elements of one type, each with its index",
        "des éléments d’un même type, chacun avec son indice",
        "elementos de um mesmo tipo, cada um com o seu índice",
    ],
}];

/// Members of the parts of a plant.
pub const PART: &[Word] = &[
    Word::free("count", ["how many parts", "le nombre de pièces", "quantas peças"]),
    Word::free("empty", ["no part", "aucune pièce", "nenhuma peça"]),
    Word::free("full", ["no room left", "plus de place", "sem lugar"]),
    Word::free("lost", ["parts that have fallen off", "pièces tombées", "peças caídas"]),
];

/// The sentence about a qualifier.
pub const fn of_qualifier(q: Qualifier) -> Told {
    match q {
        Qualifier::N => {
            ["while the step is active", "tant que l’étape est active", "enquanto a etapa está ativa"]
        }
        Qualifier::S => [
            "set, and stays so until a reset",
            "mise à 1, et le reste jusqu’à une remise à 0",
            "posta a 1, e assim fica até ser reposta a 0",
        ],
        Qualifier::R => [
            "reset; goes before everything that sets",
            "remise à 0 ; passe avant tout ce qui met à 1",
            "reposta a 0; vai antes de tudo o que põe a 1",
        ],
        Qualifier::L => [
            "while the step is active, for the time at most",
            "tant que l’étape est active, au plus pendant ce temps",
            "enquanto a etapa está ativa, no máximo esse tempo",
        ],
        Qualifier::D => [
            "while the step is active, once the time has passed",
            "tant que l’étape est active, passé ce temps",
            "enquanto a etapa está ativa, passado esse tempo",
        ],
        Qualifier::P => [
            "for one scan after activation",
            "pendant un cycle après l’activation",
            "durante um ciclo após a ativação",
        ],
        Qualifier::P0 => ["once, at deactivation", "une fois, à la désactivation", "uma vez, na desativação"],
        Qualifier::P1 => ["once, at activation", "une fois, à l’activation", "uma vez, na ativação"],
        Qualifier::SD => [
            "set once the time has passed, even if the step is left",
            "mise à 1 passé ce temps, même si l’étape est quittée",
            "posta a 1 passado esse tempo, mesmo que a etapa acabe",
        ],
        Qualifier::DS => [
            "set once the step was active for the time",
            "mise à 1 quand l’étape fut active ce temps",
            "posta a 1 quando a etapa esteve ativa esse tempo",
        ],
        Qualifier::SL => [
            "set at activation, for the time",
            "mise à 1 à l’activation, pendant ce temps",
            "posta a 1 na ativação, durante esse tempo",
        ],
    }
}

/// The sentence about a type or a function block.
pub const fn of_type(ty: Type) -> Told {
    match ty {
        Type::Bool => ["FALSE or TRUE", "FALSE ou TRUE", "FALSE ou TRUE"],
        Type::Sint => ["a whole number, 8 bits", "un entier, 8 bits", "um inteiro, 8 bits"],
        Type::Int => ["a whole number, 16 bits", "un entier, 16 bits", "um inteiro, 16 bits"],
        Type::Dint => ["a whole number, 32 bits", "un entier, 32 bits", "um inteiro, 32 bits"],
        Type::Lint => ["a whole number, 64 bits", "un entier, 64 bits", "um inteiro, 64 bits"],
        Type::Usint => [
            "a whole number from 0, 8 bits",
            "un entier à partir de 0, 8 bits",
            "um inteiro a partir de 0, 8 bits",
        ],
        Type::Uint => [
            "a whole number from 0, 16 bits",
            "un entier à partir de 0, 16 bits",
            "um inteiro a partir de 0, 16 bits",
        ],
        Type::Udint => [
            "a whole number from 0, 32 bits",
            "un entier à partir de 0, 32 bits",
            "um inteiro a partir de 0, 32 bits",
        ],
        Type::Ulint => [
            "a whole number from 0, 64 bits",
            "un entier à partir de 0, 64 bits",
            "um inteiro a partir de 0, 64 bits",
        ],
        Type::Byte => ["a string of 8 bits", "une chaîne de 8 bits", "uma cadeia de 8 bits"],
        Type::Word => ["a string of 16 bits", "une chaîne de 16 bits", "uma cadeia de 16 bits"],
        Type::Dword => ["a string of 32 bits", "une chaîne de 32 bits", "uma cadeia de 32 bits"],
        Type::Lword => ["a string of 64 bits", "une chaîne de 64 bits", "uma cadeia de 64 bits"],
        Type::Real => ["a real number, 32 bits", "un réel, 32 bits", "um número real, 32 bits"],
        Type::Lreal => ["a real number, 64 bits", "un réel, 64 bits", "um número real, 64 bits"],
        Type::Time => ["a duration", "une durée", "uma duração"],
        Type::Moment(Moment::Date) => ["a day", "un jour", "um dia"],
        Type::Moment(Moment::Tod) => ["a time of day", "une heure du jour", "uma hora do dia"],
        Type::Moment(Moment::Dt) => ["a day with a time", "un jour et une heure", "um dia com hora"],
        Type::String(_) => ["a text", "un texte", "um texto"],
        Type::Fb(FbKind::Ctu) => ["counts up", "compteur", "contador crescente"],
        Type::Fb(FbKind::Ctd) => ["counts down", "décompteur", "contador decrescente"],
        Type::Fb(FbKind::Ctud) => {
            ["counts up and down", "compteur-décompteur", "contador crescente e decrescente"]
        }
        Type::Fb(FbKind::Ton) => {
            ["on-delay timer", "temporisation à l’enclenchement", "temporizador ao ligar"]
        }
        Type::Fb(FbKind::Tof) => {
            ["off-delay timer", "temporisation au déclenchement", "temporizador ao desligar"]
        }
        Type::Fb(FbKind::Tp) => ["pulse timer", "temporisation en impulsion", "temporizador de impulso"],
        Type::Fb(FbKind::RTrig) => {
            ["finds rising edges", "détecte les fronts montants", "deteta flancos ascendentes"]
        }
        Type::Fb(FbKind::FTrig) => {
            ["finds falling edges", "détecte les fronts descendants", "deteta flancos descendentes"]
        }
        Type::Fb(FbKind::Sr) => {
            ["bistable, set dominant", "bistable, mise à 1 prioritaire", "biestável, prioridade a pôr a 1"]
        }
        Type::Fb(FbKind::Rs) => [
            "bistable, reset dominant",
            "bistable, remise à 0 prioritaire",
            "biestável, prioridade a repor a 0",
        ],
    }
}

/// The sentence about a switch of a profile.
pub const fn of_switch(s: Switch) -> Told {
    match s {
        Switch::Stable(true) => {
            ["passes until nothing changes", "des passes jusqu’à la stabilité", "passagens até nada mudar"]
        }
        Switch::Stable(false) => ["one pass a scan", "une passe par cycle", "uma passagem por ciclo"],
        Switch::MultiToken(true) => [
            "a step may be active several times",
            "une étape peut être active plusieurs fois",
            "uma etapa pode estar ativa várias vezes",
        ],
        Switch::MultiToken(false) => {
            ["a step is active or not", "une étape est active ou non", "uma etapa está ativa ou não"]
        }
        Switch::Sequential(false) => [
            "all transitions at once",
            "toutes les transitions à la fois",
            "todas as transições ao mesmo tempo",
        ],
        Switch::Sequential(true) => {
            ["one transition after the other", "une transition après l’autre", "uma transição após a outra"]
        }
        Switch::ParallelActions(true) => [
            "stored actions read the values from before",
            "les actions lisent les valeurs d’avant",
            "as ações leem os valores de antes",
        ],
        Switch::ParallelActions(false) => [
            "stored actions one after the other",
            "les actions l’une après l’autre",
            "as ações uma após a outra",
        ],
        Switch::FinalScan(true) => [
            "bodies run once more as the step ends",
            "les corps s’exécutent encore une fois à la fin",
            "os corpos correm mais uma vez no fim",
        ],
        Switch::FinalScan(false) => [
            "bodies end with their step",
            "les corps finissent avec leur étape",
            "os corpos acabam com a etapa",
        ],
        Switch::KeepStepTime(true) => [
            "the time of a step stays after it",
            "le temps d’une étape reste après elle",
            "o tempo de uma etapa fica depois dela",
        ],
        Switch::KeepStepTime(false) => [
            "the time of an inactive step is zero",
            "le temps d’une étape inactive est zéro",
            "o tempo de uma etapa inativa é zero",
        ],
        Switch::ScanClock(false) => {
            ["steps count time", "les étapes comptent le temps", "as etapas contam o tempo"]
        }
        Switch::ScanClock(true) => {
            ["steps count scans", "les étapes comptent les cycles", "as etapas contam os ciclos"]
        }
        Switch::PulseFirst(true) => {
            ["P1 first and P0 last", "P1 d’abord et P0 en dernier", "P1 primeiro e P0 no fim"]
        }
        Switch::PulseFirst(false) => [
            "actions in the order of the text",
            "les actions dans l’ordre du texte",
            "as ações pela ordem do texto",
        ],
        Switch::Bound(_) => [
            "most passes in a scan",
            "le nombre maximal de passes par cycle",
            "o máximo de passagens por ciclo",
        ],
    }
}
