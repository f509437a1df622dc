(_ "{" "}" @end) @indent
(_ "(" ")" @end) @indent
(if_statement ["END_IF" "end_if"] @end) @indent
(case_statement ["END_CASE" "end_case"] @end) @indent
(for_statement ["END_FOR" "end_for"] @end) @indent
(while_statement ["END_WHILE" "end_while"] @end) @indent
(repeat_statement ["END_REPEAT" "end_repeat"] @end) @indent
