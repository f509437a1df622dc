// The profiles under which a chart can run.
export const profiles = ['iec60848', 'iec61131', 'pl7', 'unity', 'jgrafchart'] as const;
