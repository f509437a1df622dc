// The colour of a person, the same in each page. Each has a contrast of 4.5 or more to white, the colour of the name on it.
const COLOURS = ['#c2255c', '#1864ab', '#237032', '#a84300', '#5f3dc4', '#0b6277', '#862e9c', '#4d6100'] as const;

export const colourOf = (id: number): string => COLOURS[id % COLOURS.length] ?? COLOURS[0];
