// Recognizes the charts among the files of a folder: our own, and those of other tools by their
// extensions.
export const isChart = (path: string): boolean => /\.(g7|xml|grafcet|xmi|st|sfc|exp|xsf|xef|l5x|clprj)$/i.test(path);
