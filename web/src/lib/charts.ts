// Which files of a folder are charts: our own, and those of other tools by their endings.
export const isChart = (path: string): boolean => /\.(g7|xml|grafcet|xmi|st|sfc|exp|xsf|xef|l5x|clprj)$/i.test(path);
