//! The words that go on with an item within its line, and the words of the statements of Structured Text.

use super::row::Word;

/// Words that go on with an item within its line. Where they are not reserved they are names elsewhere.
pub const CLAUSES: &[Word] = &[
    Word::reserved(
        "when",
        [
            "the receptivity: the transition clears if it is enabled and this is true",
            "la réceptivité : la transition est franchie si elle est validée et que ceci est vrai",
            "a recetividade: a transição é transposta se está validada e isto é verdade",
        ],
    ),
    Word::reserved(
        "priority",
        [
            "which of several transitions goes first",
            "laquelle de plusieurs transitions passe d’abord",
            "qual de várias transições vai primeiro",
        ],
    ),
    Word::free(
        "clearing",
        [
            "as the transition is cleared",
            "au franchissement de la transition",
            "na transposição da transição",
        ],
    ),
    Word::free(
        "on",
        [
            "statements as the transition is cleared",
            "des instructions au franchissement",
            "instruções na transposição",
        ],
    )
    .then(" clearing"),
    Word::free(
        "as",
        [
            "the form in which a link is drawn: `line` or `jump`",
            "la forme sous laquelle une liaison est dessinée : `line` ou `jump`",
            "a forma em que uma ligação é desenhada: `line` ou `jump`",
        ],
    ),
    Word::free("at", ["the address of a variable", "l’adresse d’une variable", "o endereço de uma variável"]),
    Word::free(
        "retain",
        [
            "keeps its value when the power fails",
            "garde sa valeur à la coupure de courant",
            "mantém o valor na falha de energia",
        ],
    ),
    Word::free(
        "inverted",
        ["the channel carries the complement", "le canal porte le complément", "o canal leva o complemento"],
    ),
    Word::free(
        "safe",
        [
            "the value when the controller stops",
            "la valeur à l’arrêt de l’automate",
            "o valor quando o autómato para",
        ],
    ),
    Word::free(
        "every",
        [
            "the period of a chart or of arrivals",
            "la période d’un grafcet ou des arrivées",
            "o período de um grafcet ou das chegadas",
        ],
    ),
    Word::free("block", ["a function block", "un bloc fonctionnel", "um bloco funcional"]),
    Word::free(
        "section",
        ["the receptivity as a section", "la réceptivité en section", "a recetividade numa secção"],
    ),
    Word::free("scan", ["in each scan", "à chaque cycle", "em cada ciclo"]),
    Word::reserved(
        "if",
        ["the condition of an action", "la condition d’une action", "a condição de uma ação"],
    ),
    Word::free("INIT", ["the initial situation", "la situation initiale", "a situação inicial"]),
    Word::free(
        "st",
        ["a body in Structured Text", "un corps en texte structuré", "um corpo em texto estruturado"],
    ),
    Word::free(
        "il",
        ["a body in Instruction List", "un corps en liste d’instructions", "um corpo em lista de instruções"],
    ),
    Word::free(
        "ld",
        ["a body in Ladder Diagram", "un corps en langage à contacts", "um corpo em diagrama de contactos"],
    ),
    Word::free(
        "bound",
        ["most passes in a scan", "le nombre maximal de passes par cycle", "o máximo de passagens por ciclo"],
    ),
    Word::free("in", ["the limits of a state", "les limites d’un état", "os limites de um estado"]),
    Word::free(
        "max",
        ["how many parts there are at most", "le nombre maximal de pièces", "o máximo de peças"],
    ),
    Word::free("length", ["the length of a track", "la longueur d’une voie", "o comprimento de uma pista"]),
    Word::free(
        "with",
        [
            "the plant of a test or a proof",
            "le procédé d’un test ou d’une preuve",
            "o processo de um teste ou de uma prova",
        ],
    ),
    Word::free("seed", ["where chance begins", "le départ du hasard", "o início do acaso"]),
    Word::of_iec("for", ["how long a pulse lasts", "la durée d’une impulsion", "quanto dura um impulso"]),
    Word::free("within", ["the longest time", "le temps le plus long", "o tempo mais longo"]),
    Word::of_iec(
        "until",
        [
            "up to the moment a condition holds",
            "jusqu’à ce qu’une condition soit vraie",
            "até uma condição ser verdadeira",
        ],
    ),
    Word::free(
        "fault",
        [
            "a fault, any or of this kind",
            "une faute, quelconque ou de cette sorte",
            "uma falha, qualquer ou deste tipo",
        ],
    ),
    Word::free(
        "cold",
        [
            "retained values are lost as well",
            "les valeurs gardées sont perdues aussi",
            "os valores mantidos também se perdem",
        ],
    ),
    Word::free(
        "always",
        [
            "holds in each scan of all runs",
            "vrai à chaque cycle de toute exécution",
            "verdade em cada ciclo de todas as execuções",
        ],
    ),
    Word::free(
        "never",
        [
            "holds in no scan of any run",
            "vrai à aucun cycle d’aucune exécution",
            "verdade em nenhum ciclo de nenhuma execução",
        ],
    ),
    Word::free("reachable", ["some run gets there", "une exécution y arrive", "alguma execução lá chega"]),
    Word::free(
        "after",
        [
            "what follows a condition in time",
            "ce qui suit une condition à temps",
            "o que segue uma condição a tempo",
        ],
    ),
    Word::free(
        "between",
        [
            "what never is between two conditions",
            "ce qui n’est jamais entre deux conditions",
            "o que nunca é entre duas condições",
        ],
    ),
    Word::free(
        "leads",
        [
            "one condition always leads to another",
            "une condition mène toujours à une autre",
            "uma condição leva sempre a outra",
        ],
    )
    .then(" to"),
    Word::reserved("to", ["the other condition", "l’autre condition", "a outra condição"]),
    Word::free(
        "most",
        ["so many at once at most", "tant à la fois au plus", "tantos ao mesmo tempo no máximo"],
    ),
    Word::reserved(
        "of",
        ["the conditions that are counted", "les conditions que l’on compte", "as condições que se contam"],
    ),
    Word::free("expect", ["what must follow", "ce qui doit suivre", "o que se tem de seguir"]),
    Word::reserved("and", ["the second condition", "la seconde condition", "a segunda condição"]),
];

/// Words of the statements of Structured Text.
pub const STATEMENT: &[Word] = &[
    Word::of_iec("if", ["a choice", "un choix", "uma escolha"]),
    Word::of_iec(
        "then",
        [
            "what happens if the condition holds",
            "ce qui arrive si la condition est vraie",
            "o que acontece se a condição se verifica",
        ],
    ),
    Word::of_iec("elsif", ["another condition", "une autre condition", "outra condição"]),
    Word::of_iec("else", ["what happens otherwise", "ce qui arrive sinon", "o que acontece caso contrário"]),
    Word::of_iec("end_if", ["ends `IF`", "finit `IF`", "termina `IF`"]),
    Word::of_iec("case", ["a choice by a value", "un choix selon une valeur", "uma escolha por um valor"]),
    Word::of_iec(
        "of",
        [
            "the values of a `CASE` follow",
            "les valeurs d’un `CASE` suivent",
            "seguem-se os valores de um `CASE`",
        ],
    ),
    Word::of_iec("end_case", ["ends `CASE`", "finit `CASE`", "termina `CASE`"]),
    Word::of_iec("for", ["a loop that counts", "une boucle qui compte", "um ciclo que conta"]),
    Word::of_iec(
        "to",
        ["the last value of a loop", "la dernière valeur d’une boucle", "o último valor de um ciclo"],
    ),
    Word::of_iec("by", ["the stride of a loop", "le pas d’une boucle", "o passo de um ciclo"]),
    Word::of_iec("do", ["what a loop does", "ce que fait une boucle", "o que faz um ciclo"]),
    Word::of_iec("end_for", ["ends `FOR`", "finit `FOR`", "termina `FOR`"]),
    Word::of_iec(
        "while",
        ["a loop with its condition first", "une boucle, condition d’abord", "um ciclo, primeiro a condição"],
    ),
    Word::of_iec("end_while", ["ends `WHILE`", "finit `WHILE`", "termina `WHILE`"]),
    Word::of_iec(
        "repeat",
        ["a loop with its condition last", "une boucle, condition à la fin", "um ciclo, a condição no fim"],
    ),
    Word::of_iec(
        "until",
        [
            "the condition that ends a loop",
            "la condition qui finit une boucle",
            "a condição que termina um ciclo",
        ],
    ),
    Word::of_iec("end_repeat", ["ends `REPEAT`", "finit `REPEAT`", "termina `REPEAT`"]),
    Word::of_iec("exit", ["leaves the loop", "quitte la boucle", "sai do ciclo"]),
    Word::of_iec("return", ["leaves the body", "quitte le corps", "sai do corpo"]),
];
