// Texts with which a new file can begin.
import type { Key } from '../lib/i18n';

export interface Template {
  id: string;
  title: Key;
  about: Key;
  text: string;
}

const blank = `chart G1 {
  initial step 0
}
`;

const conveyor = `// Bottle conveyor: the button starts it, five bottles stop it.
input start : BOOL "push button"
input bottle : BOOL "limit switch"
output motor : BOOL "belt"
var count : INT "bottles of this batch"

chart Conveyor {
  initial step 0
  step 1 "counting" {
    N motor
    P1 count := 0
    on ↑bottle: count := count + 1
  }

  0 -> 1 when ↑start
  1 -> 0 when count >= 5
}

plant Belt {
  parts Bottles() max 12 length 2.0

  arrivals Filler every 1s .. 3s when motor { Bottles.enter() }
  rate Bottles := 0.3 when motor
  on Bottles.at(1.99, 2.1) { Bottles.leave() }

  drive bottle := Bottles.at(1.0, 1.1)
}

test "stops after five bottles" with Belt {
  pulse start
  wait until motor
  wait until X0 within 2m
  expect count = 5, not motor
}
`;

const choice = `// A choice: left goes before right.
input left : BOOL
input right : BOOL
input back : BOOL
output to_left : BOOL
output to_right : BOOL

chart Choice {
  initial step 0
  step 1 { N to_left }
  step 2 { N to_right }

  0 -> 1 when left
  0 -> 2 when right · not left
  1 -> 0 when back
  2 -> 0 when back
}
`;

const parallel = `// Two sequences side by side: both begin together, the slower one is waited for.
input start : BOOL
input filled : BOOL
input heated : BOOL
output valve : BOOL
output heater : BOOL

chart Batch {
  initial step 0
  step 1 { N valve }
  step 2 "full"
  step 3 { N heater }
  step 4 "hot"

  0 -> (1, 3) when ↑start
  1 -> 2 when filled
  3 -> 4 when heated
  (2, 4) -> 0 when TRUE
}
`;

const macro = `// A macro-step: step M1 stands for the chart Drill.
input start : BOOL
input low : BOOL
input high : BOOL
output down : BOOL
output up : BOOL

chart Machine {
  initial step 0
  macro M1 = Drill

  0 -> M1 when ↑start
  M1 -> 0 when TRUE
}

macrochart Drill {
  entry step E { N down }
  step 1 { N up }
  exit step S

  E -> 1 when low
  1 -> S when high
}
`;

const enclosing = `// An enclosing step: while step 1 is active, the chart Work is alive.
input on : BOOL
input next : BOOL
output lamp : BOOL

chart Main {
  initial step 0
  enclosing step 1 { enclose Work }

  0 -> 1 when on
  1 -> 0 when not on
}

chart Work {
  step 10* { N lamp }
  step 11

  10 -> 11 when ↑next
  11 -> 10 when ↑next
}
`;

export const templates: Template[] = [
  { id: 'blank', title: 'start.blank', about: 'start.blank.about', text: blank },
  { id: 'conveyor', title: 'start.conveyor', about: 'start.conveyor.about', text: conveyor },
  { id: 'choice', title: 'start.choice', about: 'start.choice.about', text: choice },
  { id: 'parallel', title: 'start.parallel', about: 'start.parallel.about', text: parallel },
  { id: 'macro', title: 'start.macro', about: 'start.macro.about', text: macro },
  { id: 'enclosing', title: 'start.enclosing', about: 'start.enclosing.about', text: enclosing },
];
