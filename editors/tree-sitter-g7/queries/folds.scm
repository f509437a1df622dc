[
  (chart_body)
  (step_body)
  (plant_body)
  (test_body)
  (layout_body)
  (block)
  (foreign_body)
  (if_statement)
  (case_statement)
  (for_statement)
  (while_statement)
  (repeat_statement)
] @fold
