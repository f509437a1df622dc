//! Faults of an instance are reported at their places.

use crate::xmi::show::{bytes, import, lines};

#[test]
fn each_fault_is_named_with_its_line() {
    let file = bytes("wrong.grafcet");
    let (document, problems) = import(&file);
    let found = lines(&file, &problems);
    assert_eq!(document.charts().count(), 3);
    assert_eq!(
        found,
        [
            "G0615 6: a second variable is called `a`; it is renamed",
            "G0614 7: `5s/X1` stays a variable: several steps are called `1`",
            "G0612 8: `variableDeclarationType` is `state`; it is input, output, internal or step",
            "G0612 9: a variable of the sort `Real`",
            "G0611 9: a variable without a name; it is called `v4`",
            "G0607 10: `//@partialGrafcets.0/@steps.9` leads nowhere: there are 4 `steps`, counted from 0",
            "G0603 12: the meta-model has no attribute `colour` here; it is left out",
            "G0612 13: `initial` is `yes`; it is true or false",
            "G0611 14: a second step `1`; it is called `1_2`",
            "G0614 15: an enclosing step that encloses no chart; it is read as a step",
            "G0612 15: the identifier `two` is no whole number",
            "G0614 16: an enclosing step that encloses no chart; it is read as a step",
            "G0219 16: the chart `G` is nested in a step of its own; it is not nested",
            "G0610 18: no step stands before the transition `T1`: it is always enabled",
            "G0610 18: no step stands behind the transition `T1`: it ends its branch",
            "G0606 19: `And` takes two subterms and has 1",
            "G0605 19: `//@nowhere.0` leads nowhere: there are no `nowhere`; the chart does not need it",
            "G0610 21: no step stands before the transition `T2`: it is always enabled",
            "G0610 21: no step stands behind the transition `T2`: it ends its branch",
            "G0606 22: a term of the class `Xor`, which the meta-model does not have",
            "G0610 24: no step stands before the transition `T3`: it is always enabled",
            "G0610 24: no step stands behind the transition `T3`: it ends its branch",
            "G0606 25: a variable in a term without its declaration",
            "G0610 27: no step stands before the transition `T4`: it is always enabled",
            "G0610 27: no step stands behind the transition `T4`: it ends its branch",
            "G0607 28: `//@variableDeclarationContainer/@variableDeclarations.6` leads nowhere: there are 6 `variableDeclarations`, counted from 0",
            "G0610 30: no step stands before the transition `T5`: it is always enabled",
            "G0610 30: no step stands behind the transition `T5`: it ends its branch",
            "G0611 33: a second transition `T5`; it is called `T5_2`",
            "G0610 33: no step stands before the transition `T5_2`: it is always enabled",
            "G0610 33: no step stands behind the transition `T5_2`: it ends its branch",
            "G0605 33: the times have no effect: `timeConditionType` is none",
            "G0612 35: the value `12345678901`; it is a whole number of 32 bits",
            "G0607 36: `other.grafcet#//@variableDeclarationContainer` is a reference into another file",
            "G0609 39: synchronisations before or behind this transition meet twice or form a circle",
            "G0610 39: no step stands before the transition `T7`: it is always enabled",
            "G0606 39: a transition without a term: its receptivity is missing",
            "G0610 40: a synchronisation that leads nowhere",
            "G0609 44: an arc from a step to a step; a transition stands between two steps",
            "G0609 45: an arc from a transition to a transition; a step stands between two transitions",
            "G0609 46: the `target` of this arc stands in another chart; an arc stays in its own",
            "G0607 47: `//@partialGrafcets.0/@transitions.99` leads nowhere: there are 7 `transitions`, counted from 0",
            "G0610 48: an arc without a `target`; it is left out",
            "G0607 49: no element has the identifier `steps`",
            "G0607 50: `//partialGrafcets.0` is no reference: `partialGrafcets.0`",
            "G0606 55: an action without a variable",
            "G0606 55: a stored action without a value",
            "G0606 56: a stored action on an event that is not there",
            "G0604 57: an action writes the activity of a step; only a forcing order does",
            "G0612 58: the value `maybe`; it is true or false",
            "G0607 60: a forced step that is no step of the chart `G_2`",
            "G0605 61: the forced steps have no effect: `forcingOrderType` is currentSituation",
            "G0605 62: the term has no effect: `continuousActionType` is continuousAction",
            "G0604 66: an action of the class `Sound`, which the meta-model does not have",
            "G0605 67: an action that no step has; it is left out",
            "G0607 74: the `step` of this link is no step",
            "G0610 75: a link of an action without its `actionType`; it is left out",
            "G0603 76: the meta-model has no `hologram` here; it is left out",
            "G0611 78: `G` is also the name of something else; the chart is called `G_2`",
            "G0613 80: what the macro-step `M2` names is no expansion; it is read as a step",
            "G0607 82: the enclosing step of this chart is no step",
            "G0614 83: an enclosing step that encloses no chart; it is read as a step",
            "G0219 83: the chart `G_2` would stand inside itself: `H` is within it; it is not nested",
            "G0605 85: an empty chart is left out",
        ]
    );
}

/// A chart with the step 5, a Boolean of this name, and one transition that reads it.
fn with_boolean(name: &str, kind: &str, action: &str) -> (Vec<String>, String) {
    let text = format!(
        "<grafcet:Grafcet xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xmlns:grafcet=\"g\" xmlns:terms=\"t\">
<variableDeclarationContainer>
<variableDeclarations name=\"{name}\"{kind}><sort xsi:type=\"terms:Bool\"/></variableDeclarations>
</variableDeclarationContainer>
<partialGrafcets xsi:type=\"grafcet:PartialGrafcet\" name=\"G\">
<steps xsi:type=\"grafcet:Step\" id=\"5\" initial=\"true\"/>
<transitions id=\"1\"><term xsi:type=\"terms:Not\"><subterm xsi:type=\"terms:Variable\" variableDeclaration=\"//@variableDeclarationContainer/@variableDeclarations.0\"/></term></transitions>
<arcs source=\"//@partialGrafcets.0/@steps.0\" target=\"//@partialGrafcets.0/@transitions.0\"/>
<arcs source=\"//@partialGrafcets.0/@transitions.0\" target=\"//@partialGrafcets.0/@steps.0\"/>
{action}</partialGrafcets>
</grafcet:Grafcet>"
    );
    let (document, problems) = import(text.as_bytes());
    (lines(text.as_bytes(), &problems), g7_syntax::print(&document, None))
}

#[test]
fn a_boolean_called_like_a_time_operator_is_the_operator_or_a_warning() {
    let internal = " variableDeclarationType=\"internal\"";
    let (problems, text) = with_boolean("20ms/X5", internal, "");
    assert_eq!(problems, ["G0614 3: the Boolean `20ms/X5` is read as the time operator that its name says"]);
    assert!(text.contains("T1: 5 -> 5 when not (20ms/X5)") && !text.contains("var "), "{text}");

    let (problems, text) = with_boolean("2s/X6", "", "");
    assert_eq!(problems, ["G0614 3: `2s/X6` stays a variable: there is no step `6`"]);
    assert!(text.contains("input `2s/X6` : BOOL"), "{text}");

    let action = "<actionTypes xsi:type=\"grafcet:ContinuousAction\"><variable variableDeclaration=\"//@variableDeclarationContainer/@variableDeclarations.0\"/></actionTypes>
<actionLinks step=\"//@partialGrafcets.0/@steps.0\" actionType=\"//@partialGrafcets.0/@actionTypes.0\"/>
";
    let (problems, text) = with_boolean("2s/X5", internal, action);
    assert_eq!(problems, ["G0614 3: `2s/X5` stays a variable, because an action writes it"]);
    assert!(text.contains("N `2s/X5`"), "{text}");

    // A speed is no time.
    let (problems, _) = with_boolean("v m/s", "", "");
    assert_eq!(problems, Vec::<String>::new());
}
