//! Reasons why a question is not decided and the ways on, faults, and the answers of a comparison, in words.

use g7_engine::FaultKind;

use super::row::{Row, SCANS, STATES, Said, count, same, say};
use crate::compare::{Difference, Unlike};
use crate::reason::{Part, Reason};

/// The reason why something is not decided, as the end of a sentence.
pub fn why(reason: &Reason) -> Said {
    let number = |n: usize| same(&n.to_string());
    match reason {
        Reason::Stopped => {
            say(["the search was stopped", "la recherche a été arrêtée", "a procura foi parada"], &[])
        }
        Reason::States(n) => {
            say(["there are more than {}", "il y a plus de {}", "há mais de {}"], &[count(*n, STATES)])
        }
        Reason::Memory(mib) => say(
            [
                "the states need more than {} MiB",
                "les états demandent plus de {} Mio",
                "os estados precisam de mais de {} MiB",
            ],
            &[number(*mib)],
        ),
        Reason::Scans(n) => say(
            ["more than {} are needed", "il en faut plus de {}", "são precisos mais de {}"],
            &[count(*n, SCANS)],
        ),
        Reason::Combinations(n) => say(
            [
                "{} inputs matter at once, in more combinations than are tried",
                "{} entrées comptent à la fois, en plus de combinaisons qu’on n’en essaie",
                "{} entradas contam ao mesmo tempo, em mais combinações do que as experimentadas",
            ],
            &[number(*n)],
        ),
        Reason::Values(name) => say(
            [
                "the input `{}` takes more values than are tried",
                "l’entrée `{}` prend plus de valeurs qu’on n’en essaie",
                "a entrada `{}` toma mais valores do que os experimentados",
            ],
            &[same(name)],
        ),
        Reason::Counter(name) => say(
            [
                "`{}` is counted up, and nothing was found that ends it; its overflow is too many scans away to be shown",
                "`{}` est incrémentée, et on n’a rien trouvé qui y mette fin ; son dépassement est à trop de cycles pour être montré",
                "`{}` é incrementada, e não se encontrou nada que lhe ponha fim; o seu transbordo está a demasiados ciclos para ser mostrado",
            ],
            &[same(name)],
        ),
        Reason::NoInput(scans) => say(
            [
                "no input satisfies the assumptions {}",
                "aucune entrée ne satisfait les hypothèses {}",
                "nenhuma entrada satisfaz as hipóteses {}",
            ],
            &[behind(*scans)],
        ),
        Reason::Chance(ways) => say(
            [
                "the plant’s chance is tried in {} ways at each tick, of more",
                "le hasard de la partie opérative est essayé de {} façons à chaque pas, parmi d’autres",
                "o acaso da instalação é experimentado de {} maneiras em cada passo, entre outras",
            ],
            &[number(*ways)],
        ),
        Reason::Plant(kind) => say(
            [
                "the plant has a fault: {}",
                "la partie opérative a un défaut : {}",
                "a instalação tem uma falha: {}",
            ],
            &[fault(*kind)],
        ),
        Reason::Condition(kind) => say(
            [
                "a condition of this property cannot be evaluated: {}",
                "une condition de cette propriété ne peut être évaluée : {}",
                "uma condição desta propriedade não pode ser avaliada: {}",
            ],
            &[fault(*kind)],
        ),
        Reason::Passes(n) => say(
            [
                "a scan has more than {} passes",
                "un cycle a plus de {} passages",
                "um ciclo tem mais de {} passagens",
            ],
            &[same(&n.to_string())],
        ),
        Reason::Part(what) => say(
            [
                "only a search of all states can follow {}",
                "seule une recherche de tous les états peut suivre {}",
                "só uma procura de todos os estados pode seguir {}",
            ],
            &[part(*what)],
        ),
        Reason::Inputs
        | Reason::Assumptions
        | Reason::Reports
        | Reason::Loops
        | Reason::Future
        | Reason::LeadsOn
        | Reason::Times
        | Reason::ManyTimes
        | Reason::NotRepeated => say(plain(reason), &[]),
    }
}

/// Reasons without a name or a number.
fn plain(reason: &Reason) -> Row {
    match reason {
        Reason::Inputs => [
            "some input takes more values, or more inputs matter at once, than are tried",
            "une entrée prend plus de valeurs, ou plus d’entrées comptent à la fois, qu’on n’en essaie",
            "alguma entrada toma mais valores, ou mais entradas contam ao mesmo tempo, do que os experimentados",
        ],
        Reason::Assumptions => [
            "it is not known whether some input always satisfies the assumptions",
            "on ne sait pas si une entrée satisfait toujours les hypothèses",
            "não se sabe se alguma entrada satisfaz sempre as hipóteses",
        ],
        Reason::Reports => [
            "a scan does more than it reports",
            "un cycle fait plus qu’il n’en rapporte",
            "um ciclo faz mais do que relata",
        ],
        Reason::Loops => [
            "some scan has more passes or loops than are followed, or a condition has no value there",
            "un cycle a plus de passages ou de boucles qu’on n’en suit, ou une condition y est sans valeur",
            "algum ciclo tem mais passagens ou repetições do que as seguidas, ou uma condição não tem aí valor",
        ],
        Reason::Future => [
            "it asks what can follow, not what happens in a scan",
            "elle demande ce qui peut suivre, non ce qui arrive dans un cycle",
            "pergunta o que pode seguir-se, não o que acontece num ciclo",
        ],
        Reason::LeadsOn => [
            "no proof was found that each state leads on within a few scans",
            "on n’a pas prouvé que chaque état mène plus loin en quelques cycles",
            "não se provou que cada estado leva adiante em poucos ciclos",
        ],
        Reason::Times => [
            "a time is read in another way than by comparing it with constants",
            "une durée est lue autrement que comparée à des constantes",
            "um tempo é lido de outra forma que comparado com constantes",
        ],
        Reason::ManyTimes => [
            "too many times side by side decide if some run leads on",
            "trop de durées en parallèle décident si une exécution mène plus loin",
            "demasiados tempos em paralelo decidem se uma execução leva adiante",
        ],
        Reason::NotRepeated => [
            "the run that was found does not show it again",
            "l’exécution trouvée ne le montre pas une seconde fois",
            "a execução encontrada não o mostra outra vez",
        ],
        _ => [""; 3],
    }
}

fn behind(scans: usize) -> Said {
    if scans == 0 {
        return say(["at the start", "au début", "no início"], &[]);
    }
    let row = ["behind a run of {}", "après une exécution de {}", "depois de uma execução de {}"];
    say(row, &[count(scans, SCANS)])
}

fn part(part: Part) -> Said {
    let row = match part {
        Part::Floating => [
            "arithmetic of floating-point numbers",
            "l’arithmétique des nombres à virgule flottante",
            "a aritmética de números de vírgula flutuante",
        ],
        Part::Conversion => [
            "a conversion of a floating-point number or a text",
            "une conversion d’un nombre à virgule flottante ou d’un texte",
            "uma conversão de um número de vírgula flutuante ou de um texto",
        ],
        Part::Product => {
            ["a product of large numbers", "un produit de grands nombres", "um produto de números grandes"]
        }
        Part::Division => [
            "a division of large numbers",
            "une division de grands nombres",
            "uma divisão de números grandes",
        ],
        Part::Function(f) => {
            let row = [
                "the function `{}` of numbers that are not constant",
                "la fonction `{}` de nombres qui ne sont pas constants",
                "a função `{}` de números que não são constantes",
            ];
            return say(row, &[same(&format!("{f:?}").to_ascii_uppercase())]);
        }
        Part::Random => ["a random number", "un nombre aléatoire", "um número aleatório"],
        Part::Texts => ["a comparison of texts", "une comparaison de textes", "uma comparação de textos"],
        Part::Length => ["the length of a text", "la longueur d’un texte", "o comprimento de um texto"],
    };
    say(row, &[])
}

/// The way on from a reason; empty where none is known.
pub fn way_on(reason: &Reason) -> Said {
    let option = match reason {
        Reason::States(_) => "--states",
        Reason::Memory(_) => "--memory",
        _ => "--time",
    };
    let row = match reason {
        Reason::Stopped | Reason::States(_) | Reason::Memory(_) | Reason::Scans(_) => {
            let row = [
                "allow more with {}, or assume what the environment keeps",
                "autorisez davantage par {}, ou supposez ce que l’environnement respecte",
                "permita mais com {}, ou suponha o que o ambiente respeita",
            ];
            return say(row, &[same(option)]);
        }
        Reason::Combinations(_) => [
            "assume what the environment keeps, such as limit switches that exclude each other",
            "supposez ce que l’environnement respecte, comme des fins de course qui s’excluent",
            "suponha o que o ambiente respeita, como fins de curso que se excluem",
        ],
        Reason::Values(_) | Reason::Part(_) => [
            "compare it with constants only, or give it a smaller type",
            "ne la comparez qu’à des constantes, ou donnez-lui un type plus petit",
            "compare-a só com constantes, ou dê-lhe um tipo menor",
        ],
        Reason::Inputs => [
            "compare inputs with constants only, or give them smaller types",
            "ne comparez les entrées qu’à des constantes, ou donnez-leur des types plus petits",
            "compare as entradas só com constantes, ou dê-lhes tipos menores",
        ],
        Reason::Counter(_) => [
            "count only below a bound (`if n < 1000`), reset it in time, or give it a wider type",
            "ne comptez que sous une borne (`if n < 1000`), remettez-la à zéro à temps, ou donnez-lui un type plus grand",
            "conte só abaixo de um limite (`if n < 1000`), reponha-a a tempo, ou dê-lhe um tipo maior",
        ],
        Reason::NoInput(_) => [
            "weaken the assumptions: without inputs there are no runs, and every claim would hold",
            "affaiblissez les hypothèses : sans entrées il n’y a pas d’exécution, et tout serait vrai",
            "enfraqueça as hipóteses: sem entradas não há execuções, e tudo seria verdade",
        ],
        Reason::Assumptions => [
            "let the assumptions depend on inputs alone, or weaken them",
            "faites dépendre les hypothèses des seules entrées, ou affaiblissez-les",
            "faça as hipóteses depender só de entradas, ou enfraqueça-as",
        ],
        Reason::Chance(_) => [
            "a plant whose ticks draw no random number can be proved",
            "une partie opérative dont aucun pas ne tire de nombre au hasard peut être prouvée",
            "uma instalação cujos passos não sorteiam nenhum número pode ser provada",
        ],
        Reason::Plant(_) => [
            "mend the plant: what the chart does behind its fault is not known",
            "réparez la partie opérative : on ne sait pas ce que fait le grafcet après son défaut",
            "corrija a instalação: não se sabe o que o grafcet faz depois da sua falha",
        ],
        Reason::Condition(_) => [
            "guard it, as in `n > 0 and x / n > 2`, with a condition of its own",
            "protégez-la, comme dans `n > 0 and x / n > 2`, par une condition à elle",
            "proteja-a, como em `n > 0 and x / n > 2`, com uma condição própria",
        ],
        Reason::Passes(_) | Reason::Loops => [
            "make every evolution end first, with an edge (`↑a`) or a step that waits",
            "faites d’abord finir toute évolution, par un front (`↑a`) ou une étape qui attend",
            "faça primeiro terminar toda a evolução, com um flanco (`↑a`) ou uma etapa que espera",
        ],
        Reason::LeadsOn => [
            "allow the search of all states more with --time, or assume what the environment keeps",
            "accordez plus à la recherche de tous les états avec --time, ou supposez ce que l’environnement respecte",
            "dê mais à procura de todos os estados com --time, ou suponha o que o ambiente respeita",
        ],
        Reason::Future => [
            "this is answered by a search of all states only",
            "seule une recherche de tous les états y répond",
            "só uma procura de todos os estados responde a isto",
        ],
        Reason::Times => [
            "compare it with constants alone",
            "ne la comparez qu’à des constantes",
            "compare-o só com constantes",
        ],
        Reason::ManyTimes => [
            "ask for it with fewer times side by side",
            "posez la question avec moins de durées en parallèle",
            "pergunte com menos tempos em paralelo",
        ],
        Reason::NotRepeated => [
            "please report this: search and engine do not agree",
            "signalez-le : la recherche et le moteur ne s’accordent pas",
            "comunique-o: a procura e o motor não concordam",
        ],
        Reason::Reports => return Said::default(),
    };
    say(row, &[])
}

/// A fault in words.
pub fn fault(kind: FaultKind) -> Said {
    let [french, portuguese] = match kind {
        FaultKind::Unstable { cycle } => {
            let row = [
                "",
                "le grafcet est instable : il revient au même état après {} passages",
                "o grafcet é instável: volta ao mesmo estado depois de {} passagens",
            ];
            let [_, french, portuguese] = say(row, &[same(&cycle.to_string())]);
            return [kind.to_string(), french, portuguese];
        }
        FaultKind::Bound => [
            "pas de situation stable dans la limite des passages",
            "sem situação estável no limite de passagens",
        ],
        FaultKind::Overflow => [
            "dépassement : le résultat ne tient pas dans son type",
            "excesso: o resultado não cabe no seu tipo",
        ],
        FaultKind::DivisionByZero => ["division par zéro", "divisão por zero"],
        FaultKind::Range => ["un indice ou un texte hors limites", "um índice ou um texto fora dos limites"],
        FaultKind::Work => [
            "une boucle n’a pas fini dans le travail d’un cycle",
            "uma repetição não terminou no trabalho de um ciclo",
        ],
        FaultKind::Forcing { .. } => [
            "deux ordres de forçage d’un grafcet se contredisent",
            "duas ordens de forçagem de um grafcet contradizem-se",
        ],
        FaultKind::Table => [
            "les tables de la cible sont trop petites pour cette situation",
            "as tabelas do alvo são pequenas demais para esta situação",
        ],
        FaultKind::Inputs => [
            "les entrées ou l’heure de ce cycle ne conviennent pas au programme",
            "as entradas ou o tempo deste ciclo não servem ao programa",
        ],
        FaultKind::Stopped => ["arrêté par un défaut antérieur", "parado por uma falha anterior"],
    };
    [kind.to_string(), french.to_owned(), portuguese.to_owned()]
}

/// The first difference of two charts.
pub fn difference(what: &Difference) -> Said {
    match what {
        Difference::Output(name) => say(
            ["output `{}` has two values", "la sortie `{}` a deux valeurs", "a saída `{}` tem dois valores"],
            &[same(name)],
        ),
        Difference::Step(name) => say(
            [
                "step {} is active in one of them only",
                "l’étape {} n’est active que dans l’un d’eux",
                "a etapa {} só está ativa num deles",
            ],
            &[same(name)],
        ),
        Difference::Fault => say(
            [
                "a fault stops one of them only, or each has another",
                "un défaut n’arrête que l’un d’eux, ou chacun a le sien",
                "uma falha só para um deles, ou cada um tem a sua",
            ],
            &[],
        ),
    }
}

/// The reason why two charts cannot be compared.
pub fn unlike(why: &Unlike) -> Said {
    match why {
        Unlike::Periods => say(
            [
                "they are scanned at different periods: write the same `scan` in both",
                "leurs cycles ont des périodes différentes : écrivez le même `scan` dans les deux",
                "os seus ciclos têm períodos diferentes: escreva o mesmo `scan` em ambos",
            ],
            &[],
        ),
        Unlike::Only { output, side: 0 } => say(
            [
                "the output `{}` is in the first chart only",
                "la sortie `{}` n’est que dans le premier grafcet",
                "a saída `{}` só está no primeiro grafcet",
            ],
            &[same(output)],
        ),
        Unlike::Only { output, .. } => say(
            [
                "the output `{}` is in the second chart only",
                "la sortie `{}` n’est que dans le second grafcet",
                "a saída `{}` só está no segundo grafcet",
            ],
            &[same(output)],
        ),
        Unlike::Types(name) => {
            say(["`{}` has two types", "`{}` a deux types", "`{}` tem dois tipos"], &[same(name)])
        }
    }
}

#[cfg(test)]
mod tests {
    use g7_engine::{Builtin, FaultKind};

    use super::{way_on, why};
    use crate::reason::{Part, Reason};

    #[test]
    fn each_reason_has_its_sentence_and_way_on_in_each_language() {
        let mut all = vec![
            Reason::Stopped,
            Reason::States(7),
            Reason::Memory(7),
            Reason::Scans(7),
            Reason::Combinations(7),
            Reason::Values("level".to_owned()),
            Reason::Inputs,
            Reason::NoInput(0),
            Reason::NoInput(7),
            Reason::Assumptions,
            Reason::Chance(8),
            Reason::Plant(FaultKind::DivisionByZero),
            Reason::Condition(FaultKind::Unstable { cycle: 7 }),
            Reason::Reports,
            Reason::Passes(7),
            Reason::Loops,
            Reason::Future,
            Reason::LeadsOn,
            Reason::Times,
            Reason::ManyTimes,
            Reason::NotRepeated,
            Reason::Counter("n".to_owned()),
        ];
        let parts = [Part::Floating, Part::Conversion, Part::Product, Part::Division, Part::Random];
        all.extend(
            parts
                .into_iter()
                .chain([Part::Function(Builtin::Sqrt), Part::Texts, Part::Length])
                .map(Reason::Part),
        );
        for reason in &all {
            let [english, french, portuguese] = why(reason);
            assert!(!english.is_empty() && english != french && french != portuguese, "{reason:?}");
            assert!(![&english, &french, &portuguese].iter().any(|s| s.contains("{}")), "{english}");
            let ways = way_on(reason).map(|s| !s.is_empty());
            assert!(ways == [true; 3] || *reason == Reason::Reports, "{reason:?}");
        }
        assert_eq!(why(&Reason::NoInput(1))[0], "no input satisfies the assumptions behind a run of 1 scan");
    }
}
