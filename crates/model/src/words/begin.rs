//! The words that something begins with: an item of a file, chart or plant, an action, a statement of a test.

use super::row::Word;

// Each of these words can begin an item of a file, and also an item of a chart.
const INPUT: Word = Word::reserved(
    "input",
    ["a value from the plant", "une valeur qui vient du procédé", "um valor que vem do processo"],
);
const OUTPUT: Word = Word::reserved(
    "output",
    ["a value for the plant", "une valeur pour le procédé", "um valor para o processo"],
);
const VAR: Word =
    Word::reserved("var", ["an internal variable", "une variable interne", "uma variável interna"]);
const CONST: Word = Word::reserved("const", ["a constant", "une constante", "uma constante"]);
const SECTION: Word = Word::reserved(
    "transition",
    [
        "the receptivity of a transition as a section",
        "la réceptivité d’une transition en section",
        "a recetividade de uma transição numa secção",
    ],
)
.then(" section");
const PRE: Word = Word::free(
    "pre",
    [
        "statements before each evolution",
        "des instructions avant chaque évolution",
        "instruções antes de cada evolução",
    ],
);
const POST: Word = Word::free(
    "post",
    [
        "statements after each evolution",
        "des instructions après chaque évolution",
        "instruções depois de cada evolução",
    ],
);

/// Words that an item of a file can begin with.
pub const FILE: &[Word] = &[
    INPUT,
    OUTPUT,
    VAR,
    CONST,
    Word::reserved("chart", ["a partial chart", "un grafcet partiel", "um grafcet parcial"]),
    Word::reserved(
        "macrochart",
        ["the expansion of a macro-step", "l’expansion d’une macro-étape", "a expansão de uma macroetapa"],
    ),
    Word::reserved(
        "task",
        ["a chart that steps call", "un grafcet que des étapes appellent", "um grafcet que as etapas chamam"],
    ),
    Word::free(
        "instance",
        [
            "a chart with parameters that runs",
            "un grafcet à paramètres qui s’exécute",
            "um grafcet com parâmetros que é executado",
        ],
    ),
    Word::reserved("action", ["a named action", "une action nommée", "uma ação com nome"]),
    SECTION,
    Word::reserved("function", ["a function", "une fonction", "uma função"]),
    Word::reserved("function", ["a function block", "un bloc fonctionnel", "um bloco funcional"])
        .then(" block"),
    Word::free("struct", ["a structure", "une structure", "uma estrutura"]),
    Word::free(
        "type",
        [
            "an enumeration, a type with bounds, or a name for a type",
            "une énumération, un type à bornes, ou un nom pour un type",
            "uma enumeração, um tipo com limites, ou um nome para um tipo",
        ],
    ),
    PRE,
    POST,
    Word::reserved("plant", ["a model of the process", "un modèle du procédé", "um modelo do processo"]),
    Word::free(
        "test",
        [
            "a scenario with what must hold",
            "un scénario avec ce qui doit être vrai",
            "um cenário com o que tem de ser verdade",
        ],
    ),
    Word::reserved(
        "prove",
        [
            "a property of all runs",
            "une propriété de toutes les exécutions",
            "uma propriedade de todas as execuções",
        ],
    ),
    Word::free(
        "assume",
        ["what the inputs never do", "ce que les entrées ne font jamais", "o que as entradas nunca fazem"],
    ),
    Word::reserved("profile", ["the rules of evolution", "les règles d’évolution", "as regras de evolução"]),
    Word::free("scan", ["the nominal scan time", "la durée nominale du cycle", "o tempo nominal do ciclo"]),
    Word::free(
        "target",
        [
            "a PLC whose limits are checked",
            "un automate dont les limites sont vérifiées",
            "um autómato cujos limites são verificados",
        ],
    ),
    Word::free(
        "use",
        [
            "another file, or a part of the library",
            "un autre fichier, ou une partie de la bibliothèque",
            "outro ficheiro, ou uma parte da biblioteca",
        ],
    ),
    Word::reserved(
        "layout",
        [
            "the places of a drawn chart",
            "les places d’un grafcet dessiné",
            "os lugares de um grafcet desenhado",
        ],
    ),
];

/// Words that a part of a function block can begin with.
pub const BLOCK: &[Word] = &[
    INPUT,
    OUTPUT,
    Word::free(
        "inout",
        [
            "a parameter that stands for a variable of the caller",
            "un paramètre qui représente une variable de l’appelant",
            "um parâmetro que representa uma variável de quem chama",
        ],
    ),
    VAR,
    CONST,
    Word::free(
        "body",
        ["the statements of a call", "les instructions d’un appel", "as instruções de uma chamada"],
    ),
];

/// Words that an item of a chart can begin with, names aside.
pub const CHART: &[Word] = &[
    Word::reserved("step", ["a step", "une étape", "uma etapa"]),
    Word::reserved(
        "initial",
        [
            "a step of the initial situation",
            "une étape de la situation initiale",
            "uma etapa da situação inicial",
        ],
    )
    .then(" step"),
    Word::reserved(
        "macro",
        [
            "a macro-step; its expansion is a `macrochart`",
            "une macro-étape ; son expansion est un `macrochart`",
            "uma macroetapa; a sua expansão é um `macrochart`",
        ],
    ),
    Word::reserved("enclosing", ["an enclosing step", "une étape encapsulante", "uma etapa encapsulante"])
        .then(" step"),
    Word::free(
        "entry",
        [
            "the first step of an expansion or task",
            "la première étape d’une expansion ou d’une tâche",
            "a primeira etapa de uma expansão ou tarefa",
        ],
    )
    .then(" step"),
    Word::reserved(
        "exit",
        [
            "the last step of an expansion or task",
            "la dernière étape d’une expansion ou d’une tâche",
            "a última etapa de uma expansão ou tarefa",
        ],
    )
    .then(" step"),
    INPUT,
    OUTPUT,
    Word::reserved(
        "var",
        ["a variable of this chart", "une variable de ce grafcet", "uma variável deste grafcet"],
    ),
    Word::reserved(
        "const",
        ["a constant of this chart", "une constante de ce grafcet", "uma constante deste grafcet"],
    ),
    Word::reserved(
        "action",
        [
            "a named action of this chart",
            "une action nommée de ce grafcet",
            "uma ação com nome deste grafcet",
        ],
    ),
    SECTION,
    PRE,
    POST,
];

/// Words that an action can begin with, qualifiers aside.
pub const ACTION: &[Word] = &[
    Word::free("on", ["stored, at an event", "mémorisée, à un événement", "memorizada, num evento"]),
    Word::free(
        "each",
        [
            "in each scan while the step is active",
            "à chaque cycle tant que l’étape est active",
            "em cada ciclo enquanto a etapa está ativa",
        ],
    )
    .then(" scan:"),
    Word::free(
        "force",
        [
            "a forcing order: holds a chart in a situation",
            "un ordre de forçage : maintient un grafcet dans une situation",
            "uma ordem de forçagem: mantém um grafcet numa situação",
        ],
    ),
    Word::free(
        "enclose",
        [
            "a chart inside this enclosing step",
            "un grafcet dans cette étape encapsulante",
            "um grafcet dentro desta etapa encapsulante",
        ],
    ),
    Word::free(
        "call",
        [
            "a task runs; the step waits for its exit step",
            "une tâche s’exécute ; l’étape attend sa sortie",
            "uma tarefa é executada; a etapa espera pela saída",
        ],
    ),
    Word::free(
        "enable",
        [
            "a chart evolves only while a step enables it",
            "un grafcet n’évolue que si une étape le permet",
            "um grafcet só evolui enquanto uma etapa o permite",
        ],
    ),
    Word::free(
        "mask",
        [
            "holds the outputs of a chart back",
            "retient les sorties d’un grafcet",
            "retém as saídas de um grafcet",
        ],
    ),
];

/// Words that an item of a plant can begin with.
pub const PLANT: &[Word] = &[
    Word::free("state", ["a state of the process", "un état du procédé", "um estado do processo"]),
    Word::free(
        "rate",
        [
            "how a state moves, in units a second",
            "l’évolution d’un état, en unités par seconde",
            "como um estado se move, em unidades por segundo",
        ],
    ),
    Word::free("drive", ["what an input reads", "ce que lit une entrée", "o que uma entrada lê"]),
    Word::free(
        "on",
        [
            "once when a condition comes true",
            "une fois quand une condition devient vraie",
            "uma vez quando uma condição se torna verdadeira",
        ],
    ),
    Word::free("each", ["in every tick", "à chaque pas", "em cada passo"]),
    Word::free(
        "parts",
        ["a queue or a track of parts", "une file ou une voie de pièces", "uma fila ou uma pista de peças"],
    ),
    Word::free("arrivals", ["what arrives by itself", "ce qui arrive de soi-même", "o que chega por si"]),
    Word::reserved(
        "const",
        ["a constant of the plant", "une constante du procédé", "uma constante do processo"],
    ),
    Word::free("view", ["a picture of the plant", "une image du procédé", "uma imagem do processo"]),
];

/// Words that a statement of a test can begin with.
pub const TEST: &[Word] = &[
    Word::free(
        "set",
        ["inputs take values", "des entrées prennent des valeurs", "as entradas tomam valores"],
    ),
    Word::free(
        "pulse",
        [
            "an input is true for a moment",
            "une entrée est vraie un moment",
            "uma entrada é verdadeira por um momento",
        ],
    ),
    Word::free("wait", ["time passes", "le temps passe", "o tempo passa"]),
    Word::free(
        "wait",
        [
            "until a condition holds",
            "jusqu’à ce qu’une condition soit vraie",
            "até uma condição ser verdadeira",
        ],
    )
    .then(" until"),
    Word::free("scan", ["so many scans", "tant de cycles", "tantos ciclos"]),
    Word::free(
        "expect",
        ["this must hold now", "ceci doit être vrai maintenant", "isto tem de ser verdade agora"],
    ),
    Word::free("expect", ["a fault must come", "une faute doit venir", "uma falha tem de vir"])
        .then(" fault"),
    Word::free(
        "always",
        ["holds at each scan of the block", "vrai à chaque cycle du bloc", "verdade em cada ciclo do bloco"],
    ),
    Word::free("force", ["holds a value", "maintient une valeur", "mantém um valor"]),
    Word::free("release", ["ends a force", "met fin à un forçage", "termina uma forçagem"]),
    Word::free("restart", ["the controller starts anew", "l’automate redémarre", "o autómato recomeça"]),
    Word::reserved("repeat", ["again and again", "encore et encore", "uma e outra vez"]),
];

/// Words that a place of a layout can begin with.
pub const LAYOUT: &[Word] = &[
    Word::reserved("step", ["the place of a step", "la place d’une étape", "o lugar de uma etapa"]),
    Word::reserved(
        "transition",
        ["the place of a transition", "la place d’une transition", "o lugar de uma transição"],
    ),
    Word::free(
        "comment",
        ["the place of a comment", "la place d’un commentaire", "o lugar de um comentário"],
    ),
    Word::free(
        "link",
        [
            "the bends of a link, or the form in which it is drawn",
            "les coudes d’une liaison, ou la forme sous laquelle elle est dessinée",
            "as dobras de uma ligação, ou a forma em que é desenhada",
        ],
    ),
    Word::free(
        "actions",
        [
            "actions side by side or one below the other",
            "les actions côte à côte ou l’une sous l’autre",
            "as ações lado a lado ou uma por baixo da outra",
        ],
    ),
    Word::free(
        "sheet",
        [
            "the place of the chart on a sheet of several charts",
            "la place du grafcet sur une feuille de plusieurs grafcets",
            "o lugar do grafcet numa folha de vários grafcets",
        ],
    ),
];
