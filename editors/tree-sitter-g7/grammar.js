// The grammar of .g7 for tree-sitter. The rules follow docs/book/src/language/grammar.md; the words come
// from words.json, which is generated from the table of the program (`make grammars`).
//
// White space means nothing here, with one exception: the `(` of a call stands on the line of the name
// before it. So a text that g7 reads has a tree without errors; that a construct ends with its line is told
// by g7 itself.

/* eslint-env node */
/* global grammar, choice, seq, repeat, repeat1, optional, token, prec, field, alias */
const words = require("./words.json");

/** A word of the table; a word that is not there is a mistake of this grammar. */
function kw(text) {
  if (!words.keywords.includes(text)) throw new Error(`\`${text}\` is not in words.json`);
  return text;
}

/** A word of IEC 61131-3, in small letters or in capitals. */
function iec(text) {
  return choice(kw(text), text.toUpperCase());
}

function commas(rule) {
  return seq(rule, repeat(seq(",", rule)));
}

function items(rule) {
  return repeat(choice(rule, ";"));
}

const LETTER = "_\\p{L}\\p{Nl}";
// Combining marks of names; the overlines U+0304 and U+0305 mean `not`.
const MARK = "\\p{Nd}\\p{Pc}\\p{Mc}\\u0300-\\u0303\\u0306-\\u036f";
const NAME = `[${LETTER}][${LETTER}${MARK}]*`;
const TICKED = "`([^`\\\\\\n]|\\\\.)*`";

// From the loosest to the tightest, as model::BinaryOp::strength.
const BINARY = [
  ["or", 1, choice("or", "OR")],
  ["xor", 2, choice("xor", "XOR")],
  ["and", 3, choice("and", "AND", "&")],
  ["equality", 4, choice("=", "==", "<>", "!=", "≠")],
  ["compare", 5, choice("<", ">", "<=", ">=", "≤", "≥")],
  ["sum", 6, choice("+", "-")],
  ["product", 7, choice("*", "/", "mod", "MOD", "·", "⋅", ".")],
  ["power", 8, "**"],
];

module.exports = grammar({
  name: "g7",

  word: ($) => $.identifier,

  extras: ($) => [/[\s\uFEFF]/, $.note],

  externals: ($) => [$._block_note, $._call_open],

  supertypes: ($) => [$._expression],

  rules: {
    file: ($) => items($._item),

    _item: ($) =>
      choice(
        $.profile,
        $.cycle,
        $.target,
        $.use,
        $.variable,
        $.chart,
        $.instance,
        $.structure,
        $.type_declaration,
        $.function_block,
        $.named_action,
        $.section,
        $.function,
        $.pre,
        $.post,
        $.plant,
        $.test,
        $.prove,
        $.assume,
        $.layout,
      ),

    // Settings of the file

    profile: ($) =>
      seq(
        kw("profile"),
        field("name", alias(choice(...words.profiles), $.profile_name)),
        optional(seq("{", repeat(choice($.switch, ",", ";")), "}")),
      ),
    switch: ($) => choice(...words.switches, seq(kw("bound"), $.number)),
    cycle: ($) => seq(kw("scan"), $.duration),
    target: ($) => seq(kw("target"), alias(choice(...words.targets), $.target_name)),

    // `use 'lib/axis.g7'`, `use debounce`
    use: ($) => seq(kw("use"), choice(field("path", $.string), field("name", $._name))),

    // Variables

    variable: ($) =>
      seq(
        field("kind", choice(kw("input"), kw("output"), kw("var"), kw("const"))),
        commas(field("name", $._name)),
        ":",
        field("type", $.type),
        optional(seq(":=", field("value", $._expression))),
        repeat($._clause),
      ),
    _clause: ($) => choice($.address, kw("inverted"), kw("retain"), seq(kw("safe"), $._expression), $.comment),
    address: ($) => seq(kw("at"), choice($.direct, $._name, $.string)),
    // `ARRAY[1..6, 0..3] OF`
    array: ($) => seq(iec("array"), "[", commas(seq($._expression, "..", $._expression)), "]", iec("of")),
    type: ($) =>
      prec.right(
        seq(
          optional($.array),
          alias(choice(...words.types, ...words.types.map((t) => t.toLowerCase()), $.identifier), $.type_name),
          optional(
            choice(
              seq(alias($._call_open, "("), $._expression, optional(seq("..", $._expression)), ")"),
              seq("[", $.number, "]"),
            ),
          ),
        ),
      ),

    // Types

    structure: ($) =>
      seq(kw("struct"), field("name", $._name), optional($.comment), "{", items($.structure_member), "}"),
    structure_member: ($) =>
      seq(
        commas(field("name", $._name)),
        ":",
        field("type", $.type),
        optional(seq(":=", field("value", $._expression))),
        optional($.comment),
      ),
    // `type Mode : (Manual, Automatic := 5)`, `type Percent : INT(0..100)`
    type_declaration: ($) =>
      prec.right(
        seq(
          kw("type"),
          field("name", $._name),
          ":",
          choice($.enumeration, field("type", $.type)),
          optional(seq(":=", field("value", $._expression))),
          optional($.comment),
        ),
      ),
    enumeration: ($) => seq("(", commas($.enumeration_value), ")"),
    enumeration_value: ($) => seq(field("name", $._name), optional(seq(":=", $._expression))),
    function_block: ($) =>
      seq(
        kw("function"),
        kw("block"),
        field("name", $._name),
        optional($.comment),
        "{",
        items(choice($.variable, $.inout, $.block_body)),
        "}",
      ),
    inout: ($) =>
      seq(kw("inout"), commas(field("name", $._name)), ":", field("type", $.type), optional($.comment)),
    block_body: ($) => seq(kw("body"), $._body),

    // Charts

    chart: ($) =>
      seq(
        field("kind", choice(kw("chart"), kw("macrochart"), kw("task"))),
        field("name", $._name),
        optional($.parameters),
        optional(seq(kw("of"), field("block", $._name))),
        optional($.comment),
        optional(seq(kw("every"), $.duration)),
        field("body", $.chart_body),
      ),
    // `instance Axis[1..6]`, `instance Lift : Axis(7)`
    instance: ($) =>
      prec.right(
        seq(
          kw("instance"),
          choice(
            seq(field("chart", $._name), "[", $._expression, "..", $._expression, "]"),
            seq(field("name", $._name), ":", field("chart", $._name)),
          ),
          optional($.arguments),
          optional($.comment),
        ),
      ),
    // The name of a chart where it is used: that of an instance has an index, or the path of its function block.
    _chart_name: ($) => seq($._name, optional($._index), repeat(seq($.member, optional($._index)))),
    _index: ($) => seq(token.immediate("["), $._expression, "]"),
    chart_body: ($) => seq("{", items($._chart_item), "}"),
    _chart_item: ($) =>
      choice($.variable, $.step, $.transition, $.pre, $.post, $.named_action, $.section),

    step: ($) =>
      seq(
        repeat1(choice(kw("initial"), kw("entry"), kw("exit"), kw("enclosing"), kw("step"), kw("macro"))),
        field("name", $._name),
        optional(seq("=", field("expansion", $._chart_name))),
        optional("*"),
        optional($.comment),
        optional(field("body", $.step_body)),
      ),
    transition: ($) =>
      prec.right(seq(optional(seq(field("label", $._name), ":")), field("from", $.steps), repeat1($._arrow))),
    _arrow: ($) =>
      prec.right(seq(choice("->", "→"), field("to", $.steps), field("receptivity", $.receptivity), repeat($._tail))),
    receptivity: ($) => seq(kw("when"), $._expression),
    _tail: ($) =>
      choice(seq(kw("priority"), $.number), $.comment, seq(kw("on"), kw("clearing"), optional(":"), $.block)),
    steps: ($) => choice($._name, seq("(", optional(commas($._name)), ")")),

    // Actions

    step_body: ($) => seq("{", items($._action), "}"),
    _action: ($) =>
      choice(
        $.qualified_action,
        $.event_action,
        $.scan_action,
        $.force_order,
        seq(choice(kw("enable"), kw("mask"), kw("call"), kw("enclose")), $._chart_name),
        $.comment,
      ),
    qualified_action: ($) =>
      prec.right(
        seq(
          field("qualifier", $.qualifier),
          optional(field("time", choice($.duration, seq("(", $._expression, ")")))),
          choice($.path, $.element, $.direct, $.assignment, $.call, $.block),
          optional($.condition),
        ),
      ),
    qualifier: () => choice(...words.qualifiers),
    condition: ($) => seq(kw("if"), $._expression),
    event_action: ($) => seq(kw("on"), $._expression, ":", $._work),
    scan_action: ($) => seq(kw("each"), kw("scan"), ":", $._work, optional($.condition)),
    force_order: ($) => seq(kw("force"), field("chart", $._chart_name), ":=", $.situation),
    situation: ($) =>
      choice(kw("INIT"), seq("{", choice(kw("INIT"), "*", optional(commas($._name))), "}")),
    _work: ($) => choice($.assignment, $.call, $.block),

    named_action: ($) => seq(kw("action"), field("name", $._name), optional($.comment), $._body),
    section: ($) =>
      seq(
        kw("transition"),
        kw("section"),
        field("name", $._name),
        choice($.block, seq(":=", $._expression)),
      ),
    function: ($) =>
      seq(kw("function"), field("name", $._name), $.parameters, ":", $.type, field("body", $.block)),
    parameters: ($) => seq("(", repeat(choice($.parameter, ",", ";")), ")"),
    parameter: ($) => seq(field("name", $._name), ":", $.type),
    pre: ($) => seq(kw("pre"), $._body),
    post: ($) => seq(kw("post"), $._body),
    _body: ($) =>
      choice(
        seq(optional(kw("st")), $.block),
        seq(field("language", choice(kw("il"), kw("ld"))), $.foreign_body),
      ),
    // Instruction List and Ladder, as they stand.
    foreign_body: ($) => seq("{", repeat(choice($.foreign_text, $._foreign_braces)), "}"),
    _foreign_braces: ($) => seq("{", repeat(choice($.foreign_text, $._foreign_braces)), "}"),
    foreign_text: () => token(prec(1, /[^{}]+/)),

    // Structured Text

    block: ($) => seq("{", items(choice($.local, $._statement)), "}"),
    local: ($) =>
      seq(kw("var"), commas(field("name", $._name)), ":", $.type, optional(seq(":=", $._expression))),
    _statements: ($) => repeat1(choice($._statement, ";")),
    _statement: ($) =>
      choice(
        $.assignment,
        $.call,
        $.if_statement,
        $.case_statement,
        $.for_statement,
        $.while_statement,
        $.repeat_statement,
        $.exit_statement,
        $.return_statement,
      ),
    assignment: ($) => prec.right(seq(field("target", choice($.path, $.element, $.direct)), ":=", field("value", $._expression))),
    if_statement: ($) =>
      seq(
        iec("if"),
        $._expression,
        iec("then"),
        optional($._statements),
        repeat(seq(iec("elsif"), $._expression, iec("then"), optional($._statements))),
        optional(seq(iec("else"), optional($._statements))),
        iec("end_if"),
      ),
    case_statement: ($) =>
      seq(
        iec("case"),
        $._expression,
        iec("of"),
        items(choice($.case_label, $._statement)),
        optional(seq(iec("else"), optional(":"), optional($._statements))),
        iec("end_case"),
      ),
    // A label, not an arm: where an arm ends is seen only behind the first value of the next one.
    case_label: ($) => seq(commas($._label), ":"),
    _label: ($) => seq($._label_value, optional(seq("..", $._label_value))),
    _label_value: ($) =>
      choice($.number, $.duration, $.string, $.boolean, $.path, $.group, alias($.signed, $.unary)),
    signed: ($) => seq(choice("-", "+"), choice($.number, $.duration)),
    for_statement: ($) =>
      seq(
        iec("for"),
        field("variable", $._name),
        ":=",
        $._expression,
        iec("to"),
        $._expression,
        optional(seq(iec("by"), $._expression)),
        iec("do"),
        optional($._statements),
        iec("end_for"),
      ),
    while_statement: ($) =>
      seq(iec("while"), $._expression, iec("do"), optional($._statements), iec("end_while")),
    repeat_statement: ($) =>
      seq(iec("repeat"), optional($._statements), iec("until"), $._expression, iec("end_repeat")),
    exit_statement: () => iec("exit"),
    return_statement: () => iec("return"),

    // Plants

    plant: ($) =>
      seq(kw("plant"), field("name", $._name), optional($.comment), field("body", $.plant_body)),
    plant_body: ($) => seq("{", items($._plant_item), "}"),
    _plant_item: ($) =>
      choice($.plant_const, $.state, $.rate, $.drive, $.plant_event, $.tick, $.parts, $.arrivals, $.view),
    plant_const: ($) =>
      seq(kw("const"), commas(field("name", $._name)), ":", $.type, ":=", $._expression, optional($.comment)),
    state: ($) =>
      seq(
        kw("state"),
        commas(field("name", $._name)),
        ":",
        $.type,
        optional(seq(":=", $._expression)),
        optional(seq(kw("in"), $._expression, "..", $._expression)),
        optional($.comment),
      ),
    rate: ($) =>
      seq(kw("rate"), field("name", $._name), ":=", $._expression, optional(seq(kw("when"), $._expression))),
    drive: ($) =>
      seq(kw("drive"), field("name", choice($._name, $.element)), ":=", $._expression),
    plant_event: ($) => seq(kw("on"), $._expression, $.block),
    tick: ($) => seq(kw("each"), $.block),
    parts: ($) =>
      seq(
        kw("parts"),
        field("name", $._name),
        $.parameters,
        kw("max"),
        $.number,
        optional(seq(kw("length"), $._expression)),
        optional(seq(":=", commas($.part))),
      ),
    part: ($) => seq("(", optional(commas($._expression)), ")"),
    arrivals: ($) =>
      seq(
        kw("arrivals"),
        field("name", $._name),
        kw("every"),
        $._expression,
        optional(seq("..", $._expression)),
        optional(seq(kw("when"), $._expression)),
        $.block,
      ),
    view: ($) => seq(kw("view"), choice($.string, $.comment), optional(seq("{", items($.binding), "}"))),
    binding: ($) => seq(field("element", $._name), $.member, ":=", $._expression),

    // Tests and properties

    test: ($) =>
      seq(
        kw("test"),
        field("name", choice($.comment, $.string)),
        optional($.with),
        optional(seq(kw("seed"), $.number)),
        field("body", $.test_body),
      ),
    with: ($) => seq(kw("with"), $._name),
    test_body: ($) => seq("{", items($._test_statement), "}"),
    _test_statement: ($) =>
      choice(
        $.set,
        $.pulse,
        $.wait,
        $.scan,
        $.expect,
        $.expect_fault,
        $.always,
        $.test_force,
        $.release,
        $.restart,
        $.test_repeat,
        $.comment,
      ),
    _settable: ($) => choice($.path, $.element, $.direct),
    set: ($) => seq(kw("set"), commas(seq($._settable, ":=", $._expression))),
    pulse: ($) => seq(kw("pulse"), $._settable, optional(seq(iec("for"), $.duration))),
    wait: ($) =>
      seq(
        kw("wait"),
        choice($.duration, seq(iec("until"), $._expression, optional(seq(kw("within"), $.duration)))),
      ),
    scan: ($) => seq(kw("scan"), optional($.number)),
    expect: ($) => seq(kw("expect"), commas($._expression)),
    expect_fault: ($) => seq(kw("expect"), kw("fault"), optional($._name)),
    always: ($) => seq(kw("always"), commas($._expression), $.test_body),
    test_force: ($) => seq(kw("force"), $._settable, ":=", $._expression),
    release: ($) => seq(kw("release"), $._settable),
    restart: ($) => seq(kw("restart"), optional(kw("cold"))),
    test_repeat: ($) => seq(kw("repeat"), $.number, $.test_body),

    prove: ($) => seq(kw("prove"), $._property, optional($.with), optional($.comment)),
    _property: ($) =>
      choice(
        seq(choice(kw("always"), kw("never"), kw("reachable")), $._expression),
        seq(
          kw("after"),
          $._expression,
          choice(seq(kw("within"), $.duration), seq(iec("until"), $._expression)),
          kw("expect"),
          $._expression,
        ),
        prec.right(seq(kw("between"), $._expression, kw("and"), $._expression, kw("never"), $._expression)),
        seq($._expression, kw("leads"), kw("to"), $._expression),
        seq(kw("at"), kw("most"), $.number, kw("of"), "(", commas($._expression), ")"),
      ),
    assume: ($) => seq(kw("assume"), $._expression, optional($.comment)),

    layout: ($) => seq(kw("layout"), field("chart", $._name), field("body", $.layout_body)),
    layout_body: ($) => seq("{", items($.place), "}"),
    place: ($) =>
      choice(
        seq(choice($._placed, seq(kw("comment"), choice($.comment, $.string)), kw("sheet")), kw("at"), $._point),
        seq(kw("actions"), optional(seq(kw("of"), kw("step"), $._name)), kw("in"), choice("row", "column")),
        seq(kw("link"), $._placed, "->", $._placed, choice($._bends, seq(kw("as"), choice("line", "jump")))),
      ),
    _bends: ($) => seq(kw("at"), $._point, repeat(seq(",", $._point))),
    _placed: ($) => choice(seq(kw("step"), $._name), seq(kw("transition"), choice($._name, seq("#", $.number)))),
    _point: ($) => seq("(", optional("-"), $.number, ",", optional("-"), $.number, ")"),

    // Expressions

    _expression: ($) =>
      choice(
        $.number,
        $.duration,
        $.string,
        $.boolean,
        $.path,
        $.element,
        $.direct,
        $.call,
        $.group,
        $.always_true,
        $.edge,
        $.delay,
        $.timer,
        $.unary,
        $.complement,
        $.binary,
      ),
    boolean: () => choice("TRUE", "FALSE", kw("true"), kw("false")),
    // Brackets hold one expression, or the values of an array or of a structure.
    group: ($) =>
      choice(seq("(", choice($._expression, commas($.field)), ")"), seq("[", commas(choice($._expression, $.repeated)), "]")),
    field: ($) => seq(field("name", $._name), ":=", field("value", $._expression)),
    repeated: ($) => seq($.number, alias($._call_open, "("), $._expression, ")"),
    always_true: () => seq("=", "1"),
    edge: ($) => seq(choice(kw("rise"), kw("fall")), "(", $._expression, ")"),
    delay: ($) =>
      seq(kw("delay"), "(", $._expression, ",", $._expression, optional(seq(",", $._expression)), ")"),
    timer: ($) => prec.right(10, seq($.duration, "/", $._expression, optional(seq("/", $.duration)))),
    unary: ($) =>
      prec(9, seq(field("operator", choice("not", "NOT", "!", "/", "-", "+", "↑", "^", "↓")), $._expression)),
    complement: ($) => prec(11, seq($._expression, token.immediate(/['\u0304\u0305]/))),
    binary: ($) =>
      choice(
        ...BINARY.map(([, strength, operator]) =>
          prec.left(strength, seq($._expression, field("operator", operator), $._expression)),
        ),
      ),
    call: ($) => prec(12, seq(field("function", choice($.path, $.element)), $.arguments)),
    // The bracket stands close behind the name of the array.
    element: ($) =>
      prec(
        12,
        seq(
          field("array", choice($.path, $.element)),
          token.immediate("["),
          commas($._expression),
          "]",
          repeat($.member),
        ),
      ),
    arguments: ($) => seq(alias($._call_open, "("), optional(commas($.argument)), optional(","), ")"),
    argument: ($) =>
      seq(optional(seq(field("name", $._name), choice(":=", "=>"))), $._expression),
    path: ($) =>
      prec.right(
        choice(
          seq(choice($.identifier, $.ticked), repeat($.member)),
          seq(alias($.number, $.identifier), repeat1($.member)),
        ),
      ),
    // The dot of a path and the name behind it stand close together.
    member: () => token.immediate(new RegExp(`\\.(${NAME}|[0-9]+|${TICKED})`)),

    // Words

    _name: ($) => choice($.identifier, $.ticked, alias($.number, $.identifier)),
    identifier: () => new RegExp(NAME),
    ticked: () => new RegExp(TICKED),
    number: () =>
      token(
        choice(
          /[0-9][0-9_]*(\.[0-9][0-9_]*)?([eE][+-]?[0-9][0-9_]*)?/,
          /[0-9]+#[0-9A-Za-z_]+/,
          /[A-Za-z_]+#[0-9]+(-[0-9]+-[0-9]+(-[0-9]+:[0-9:]+(\.[0-9]+)?)?|:[0-9:]+(\.[0-9]+)?)/,
          /[A-Za-z]+#[+-]?[0-9A-Za-z_]+([.#][0-9A-Za-z_]+)?([eE][+-]?[0-9]+)?/,
        ),
      ),
    duration: () =>
      token(
        prec(
          1,
          choice(
            /[0-9][0-9_]*(\.[0-9][0-9_]*)?(d|h|ms|us|ns|m|s|D|H|MS|US|NS|M|S)([0-9_.a-zA-Z]*)/,
            /[lL]?([tT]|[tT][iI][mM][eE])#[+-]?[0-9][0-9_.a-zA-Z]*/,
          ),
        ),
      ),
    direct: () => /%[A-Za-z][A-Za-z0-9_]*(\.[A-Za-z0-9]+)*(:[Xx][0-9]+)?/,
    string: () => /'([^'$\n]|\$.)*'/,
    comment: () => /"([^"\\\n]|\\.)*"/,

    note: ($) => choice(/\/\/[^\n]*/, $._block_note),
  },
});
