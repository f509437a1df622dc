import type { Words } from '../i18n';

/** The words of the print preview. */
export const print = {
  'print.title': ['Print', 'Imprimer', 'Imprimir'],
  'print.what': ['Print', 'Imprimer', 'Imprimir'],
  'print.chart': ['this chart', 'ce grafcet', 'este grafcet'],
  'print.charts': ['all charts', 'tous les grafcets', 'todos os grafcets'],
  'print.dossier': ['the whole dossier', 'le dossier entier', 'o dossiê inteiro'],
  'print.paper': ['Paper', 'Papier', 'Papel'],
  'print.a4': ['A4', 'A4', 'A4'],
  'print.a4-landscape': ['A4 on its side', 'A4 en largeur', 'A4 ao baixo'],
  'print.a3': ['A3', 'A3', 'A3'],
  'print.a3-landscape': ['A3 on its side', 'A3 en largeur', 'A3 ao baixo'],
  'print.block': ['Title block', 'Cartouche', 'Legenda'],
  'print.name': ['Title', 'Titre', 'Título'],
  'print.author': ['Author', 'Auteur', 'Autor'],
  'print.company': ['Company', 'Société', 'Empresa'],
  'print.revision': ['Revision', 'Révision', 'Revisão'],
  'print.date': ['Date', 'Date', 'Data'],
  'print.go': ['Print ({n})', 'Imprimer ({n})', 'Imprimir ({n})'],
  'print.sheet': ['sheet {n} of {of}', 'feuille {n} sur {of}', 'folha {n} de {of}'],
  'print.before': ['Sheet before', 'Feuille précédente', 'Folha anterior'],
  'print.next': ['Next sheet', 'Feuille suivante', 'Folha seguinte'],
  'print.making': ['The sheets are being made …', 'Les feuilles se préparent …', 'As folhas estão a ser feitas …'],
  'print.tests': [
    'The tests are run for the dossier. Questions have the answers of the panel Prove; those that it has not asked stand there as not asked.',
    'Les essais sont exécutés pour le dossier. Les questions ont les réponses du panneau Prouver ; celles qu’il n’a pas posées y figurent comme non posées.',
    'Os testes são executados para o dossiê. As perguntas têm as respostas do painel Provar; as que não foram feitas figuram como tal.',
  ],
} as const satisfies Words;
