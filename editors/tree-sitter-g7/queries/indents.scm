; For Helix; Neovim reads the same names with `indent.` before them.
[
  (chart_body)
  (step_body)
  (plant_body)
  (test_body)
  (layout_body)
  (block)
  (if_statement)
  (case_statement)
  (for_statement)
  (while_statement)
  (repeat_statement)
] @indent

["}" ")" "]" "END_IF" "end_if" "ELSE" "else" "ELSIF" "elsif" "END_CASE" "end_case" "END_FOR" "end_for" "END_WHILE" "end_while" "UNTIL" "until"] @outdent
