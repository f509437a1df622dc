; For Zed: what stands in the outline.
(chart kind: _ @context name: (_) @name) @item
(plant "plant" @context name: (_) @name) @item
(test "test" @context name: (_) @name) @item
(function "function" @context name: (_) @name) @item
(named_action "action" @context name: (_) @name) @item
(section "section" @context name: (_) @name) @item
(step ["step" "macro"] @context name: (_) @name) @item
(prove "prove" @context) @item
