// The profiles that a chart can be run under.
export const profiles = ['iec60848', 'iec61131', 'pl7', 'unity', 'jgrafchart'] as const;
