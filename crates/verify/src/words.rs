//! Claims, verdicts and what shows them, in words. The command line and the page read the one table
//! that stands here: each sentence in English, French and Portuguese.

mod open;
mod row;

use g7_compile::Compiled;
use g7_model::Nanos;

use crate::question::{Claim, Question};
use crate::verdict::{Certificate, Evidence, Open, Verdict};
pub use open::{difference, fault, unlike, way_on, why};
pub use row::Said;
use row::{Counted, NODES, PAIRS, Row, SCANS, STATES, ZONES, count, same, say};

const ACTIVE: Row = ["step {} can be active", "l’étape {} peut être active", "a etapa {} pode estar ativa"];
const CLEARS: Row =
    ["transition {} can clear", "la transition {} peut être franchie", "a transição {} pode ser transposta"];
const RUNS: Row = ["action `{}` can run", "l’action `{}` peut s’exécuter", "a ação `{}` pode executar-se"];
const ON: Row = [
    "output `{}` can be other than 0",
    "la sortie `{}` peut être autre que 0",
    "a saída `{}` pode ser diferente de 0",
];
const ASKED: Row = ["input `{}` is asked for", "l’entrée `{}` est consultée", "a entrada `{}` é consultada"];
const NO_DEADLOCK: Row = ["no deadlock", "pas de blocage", "sem bloqueio"];
const NO_CONFLICT: Row = [
    "no conflict: no two transitions of one step are clearable at once",
    "pas de conflit : jamais deux transitions d’une étape ne sont franchissables ensemble",
    "sem conflito: nunca duas transições de uma etapa são transponíveis ao mesmo tempo",
];
const NO_UNSAFE: Row = [
    "no step is activated while it is active",
    "aucune étape n’est activée pendant qu’elle est active",
    "nenhuma etapa é ativada enquanto está ativa",
];
const NO_INSTABILITY: Row = ["every evolution ends", "toute évolution se termine", "toda a evolução termina"];
const NO_OPPOSED_WRITES: Row = [
    "no pass gives a variable two values",
    "aucun passage ne donne deux valeurs à une variable",
    "nenhuma passagem dá dois valores a uma variável",
];
const NO_OPPOSED_ORDERS: Row =
    ["forcing orders agree", "les ordres de forçage s’accordent", "as ordens de forçagem concordam"];
const NO_FAULT: Row = ["no fault", "pas de défaut", "sem falha"];
const PLAIN: Row = ["{}", "{}", "{}"];

const PROVED: Row = ["proved", "prouvé", "provado"];
const REFUTED: Row = ["refuted", "réfuté", "refutado"];
const OPEN: Row = ["not decided", "non décidé", "não decidido"];

const RUN: Row =
    ["shown by a run of {}, {}", "montré par une exécution de {}, {}", "mostrado por uma execução de {}, {}"];
const FAULT: Row = [", with a fault: {}", ", avec un défaut : {}", ", com uma falha: {}"];
const SEARCH: Row =
    ["all of {} visited by {}", "la totalité de {} visitée par {}", "a totalidade de {} visitada por {}"];
const INVARIANT: Row = [
    "an invariant of {}, which was checked",
    "un invariant de {}, qui a été vérifié",
    "um invariante de {}, que foi verificado",
];
const DIAGRAM: Row = [
    "all of {}, a set of {}, which was checked",
    "la totalité de {}, un ensemble de {}, qui a été vérifié",
    "a totalidade de {}, um conjunto de {}, que foi verificado",
];
const DRAWN: Row = [
    "all of {}, a set of {}, which states at random did not leave",
    "la totalité de {}, un ensemble de {}, dont des états au hasard ne sont pas sortis",
    "a totalidade de {}, um conjunto de {}, do qual estados ao acaso não saíram",
];
const COUNTLESS: Row = ["more than 10^38 states", "plus de 10^38 états", "mais de 10^38 estados"];
const INDUCTION: Row = [
    "induction over {}, which was checked",
    "une récurrence sur {}, qui a été vérifiée",
    "uma indução sobre {}, que foi verificada",
];
const SO_FAR: Row = [
    "no run of up to {} decides it ({} visited): {}",
    "aucune exécution de {} au plus n’en décide ({} visités) : {}",
    "nenhuma execução de até {} o decide ({} visitados): {}",
];

const CLAUSES: Counted =
    [["{} clause", "{} clause", "{} cláusula"], ["{} clauses", "{} clauses", "{} cláusulas"]];

/// The claim of a question. `written` is the text at its place.
pub fn claim(written: &str, compiled: &Compiled, question: &Question) -> Said {
    let symbols = &compiled.symbols;
    let variable = |a| same(symbols.variable_at(a).map_or("", |v| &*v.name));
    let written = written.split_whitespace().collect::<Vec<_>>().join(" ");
    match &question.claim {
        Claim::Active(step) => say(ACTIVE, &[same(symbols.step_name(*step))]),
        Claim::Clears(rank) => {
            let text = symbols.transition_text(*rank);
            let whole = symbols.label(*rank).map_or(text.to_owned(), |label| format!("{label}: {text}"));
            say(CLEARS, &[same(&whole)])
        }
        Claim::Runs(_) => say(RUNS, &[same(&shortened(&written))]),
        Claim::On(addr) => say(ON, &[variable(*addr)]),
        Claim::Asked(addr) => say(ASKED, &[variable(*addr)]),
        Claim::NoDeadlock => say(NO_DEADLOCK, &[]),
        Claim::NoConflict => say(NO_CONFLICT, &[]),
        Claim::NoUnsafe => say(NO_UNSAFE, &[]),
        Claim::NoInstability => say(NO_INSTABILITY, &[]),
        Claim::NoOpposedWrites => say(NO_OPPOSED_WRITES, &[]),
        Claim::NoOpposedOrders => say(NO_OPPOSED_ORDERS, &[]),
        Claim::NoFault => say(NO_FAULT, &[]),
        Claim::Always(_)
        | Claim::Never(_)
        | Claim::Reachable(_)
        | Claim::AtMost(..)
        | Claim::Within { .. }
        | Claim::Until { .. }
        | Claim::Between { .. }
        | Claim::LeadsTo { .. } => say(PLAIN, &[same(&written)]),
    }
}

fn shortened(text: &str) -> String {
    if text.chars().count() > 40 { text.chars().take(39).chain(['…']).collect() } else { text.to_owned() }
}

/// The word for an answer.
pub fn verdict(verdict: &Verdict) -> Said {
    say(
        match verdict {
            Verdict::Proved(_) => PROVED,
            Verdict::Refuted(_) => REFUTED,
            Verdict::Open(_) => OPEN,
        },
        &[],
    )
}

/// The evidence of an answer in one line. `time` is that of the last scan of its run, if it has one.
pub fn reason(verdict: &Verdict, time: Nanos) -> Said {
    match verdict {
        Verdict::Open(Open { scans, states, reason, .. }) => {
            say(SO_FAR, &[count(*scans, SCANS), count(*states, STATES), why(reason)])
        }
        Verdict::Proved(e) | Verdict::Refuted(e) => match e {
            Evidence::Run(run) => {
                let shown = say(RUN, &[count(run.moves.len(), SCANS), same(&time.plain())]);
                let Some(stopped) = run.fault else { return shown };
                let fault = say(FAULT, &[fault(stopped.kind)]);
                say(["{}{}", "{}{}", "{}{}"], &[shown, fault])
            }
            Evidence::Certificate(c) => certificate(c, STATES),
        },
    }
}

/// The proof that two charts are equal, in one line: its states are pairs of states.
pub fn equal(proof: &Certificate) -> Said {
    certificate(proof, PAIRS)
}

fn certificate(proof: &Certificate, of_states: Counted) -> Said {
    match proof {
        Certificate::Search { states, scans } => {
            say(SEARCH, &[count(*states, of_states), count(*scans, SCANS)])
        }
        Certificate::Zones { zones, scans } => say(SEARCH, &[count(*zones, ZONES), count(*scans, SCANS)]),
        Certificate::Diagram { states, nodes, checked } => {
            let states = match states {
                Some(n) => count(*n, of_states),
                None => say(COUNTLESS, &[]),
            };
            say(if *checked { DIAGRAM } else { DRAWN }, &[states, count(*nodes, NODES)])
        }
        Certificate::Invariant { clauses } => say(INVARIANT, &[count(*clauses, CLAUSES)]),
        Certificate::Induction { depth } => say(INDUCTION, &[count(*depth, SCANS)]),
    }
}

/// The way out of a claim that fails, or that is not decided; empty where there is none to be told.
pub fn help(question: &Question, verdict: &Verdict) -> Said {
    match verdict {
        Verdict::Open(open) => way_on(&open.reason),
        Verdict::Refuted(_) => way_out(&question.claim).map_or_else(Said::default, |row| say(row, &[])),
        Verdict::Proved(_) => Said::default(),
    }
}

fn way_out(claim: &Claim) -> Option<Row> {
    Some(match claim {
        Claim::NoDeadlock => [
            "give the last situation of the run a transition that some input clears",
            "donnez à la dernière situation de l’exécution une transition qu’une entrée franchit",
            "dê à última situação da execução uma transição que alguma entrada transponha",
        ],
        Claim::NoConflict => [
            "exclude the receptivities (`a and not b`), or give both a `priority` where the profile follows it",
            "excluez les réceptivités (`a and not b`), ou donnez aux deux une `priority` si le profil la suit",
            "exclua as recetividades (`a and not b`), ou dê a ambas uma `priority` se o perfil a seguir",
        ],
        Claim::NoUnsafe => [
            "let the token before leave the step first, or join the sequences",
            "laissez d’abord l’étape se désactiver, ou réunissez les séquences",
            "deixe primeiro a etapa desativar-se, ou junte as sequências",
        ],
        Claim::NoInstability => [
            "put an edge (`↑a`) or a step that waits into the loop",
            "mettez un front (`↑a`) ou une étape qui attend dans la boucle",
            "ponha um flanco (`↑a`) ou uma etapa que espera no ciclo",
        ],
        Claim::NoOpposedWrites => [
            "write the variable in one place, or exclude the steps",
            "écrivez la variable à un seul endroit, ou excluez les étapes",
            "escreva a variável num só lugar, ou exclua as etapas",
        ],
        Claim::NoFault => [
            "guard the operation, or widen the type",
            "protégez l’opération, ou élargissez le type",
            "proteja a operação, ou alargue o tipo",
        ],
        _ => return None,
    })
}
