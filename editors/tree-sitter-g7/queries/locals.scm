(file) @local.scope
(chart) @local.scope
(function) @local.scope
(plant) @local.scope
(block) @local.scope

(variable name: (identifier) @local.definition)
(local name: (identifier) @local.definition)
(parameter name: (identifier) @local.definition)
(state name: (identifier) @local.definition)
(plant_const name: (identifier) @local.definition)
(step name: (identifier) @local.definition)

(path (identifier) @local.reference)
(steps (identifier) @local.reference)
