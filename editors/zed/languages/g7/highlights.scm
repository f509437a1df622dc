; Generated from the table of words of G7 by `make grammars`; do not edit.

(note) @comment
(comment) @string.special
(string) @string
(number) @number
(duration) @number
(boolean) @boolean
(direct) @variable.builtin
(qualifier) @attribute
(profile_name) @constant
(target_name) @constant
(switch) @constant
(type_name) @type
(member) @variable.member
(identifier) @variable
(ticked) @variable

(chart name: (_) @type)
(plant name: (_) @type)
(step name: (_) @label)
(step expansion: (_) @type)
(steps (_) @label)
(transition label: (_) @label)
(function name: (_) @function)
(named_action name: (_) @function)
(section name: (_) @function)
(call function: (path) @function.call)
(force_order chart: (_) @type)
(layout chart: (_) @type)
(parameter name: (_) @variable.parameter)

["->" "→" ":=" "=>" "=" "<>" "!=" "<" ">" "<=" ">=" "+" "-" "*" "/" "**" "&" "!" "↑" "↓" "^" ".."] @operator
["{" "}" "(" ")" "[" "]"] @punctuation.bracket
["," ";" ":"] @punctuation.delimiter

[
  "BY" "CASE" "DO" "ELSE" "ELSIF" "END_CASE" "END_FOR" "END_IF"
  "END_REPEAT" "END_WHILE" "EXIT" "FOR" "IF" "INIT" "OF" "REPEAT"
  "RETURN" "THEN" "TO" "UNTIL" "WHILE" "action" "actions" "after"
  "always" "arrivals" "as" "assume" "at" "between" "block" "bound"
  "by" "call" "case" "chart" "clearing" "cold" "comment" "const"
  "do" "drive" "each" "else" "elsif" "enable" "enclose" "enclosing"
  "end_case" "end_for" "end_if" "end_repeat" "end_while" "entry" "every" "exit"
  "expect" "fault" "for" "force" "function" "if" "il" "in"
  "initial" "input" "instance" "inverted" "layout" "ld" "leads" "length"
  "link" "macro" "macrochart" "mask" "max" "most" "never" "of"
  "on" "output" "parts" "plant" "post" "pre" "priority" "profile"
  "prove" "pulse" "rate" "reachable" "release" "repeat" "restart" "retain"
  "return" "safe" "scan" "section" "seed" "set" "sheet" "st"
  "state" "step" "struct" "target" "task" "test" "then" "to"
  "transition" "type" "until" "use" "var" "view" "wait" "when"
  "while" "with" "within"
] @keyword

[
  "AND" "MOD" "NOT" "OR" "XOR" "and" "mod" "not"
  "or" "xor" "delay" "fall" "rise"
] @keyword.operator
