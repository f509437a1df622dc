import type { Words } from '../i18n';

export const why = {
  'why.title': ['Why', 'Pourquoi', 'Porquê'],
  'why.ask': ['Why?', 'Pourquoi ?', 'Porquê?'],
  'why.of': ['Why is {name} so?', 'Pourquoi {name} est-il ainsi ?', 'Porque está {name} assim?'],
  'why.symbol': ['Why is it so in this run?', 'Pourquoi, dans cette exécution ?', 'Porquê, nesta execução?'],
  'why.name': ['Variable or step', 'Variable ou étape', 'Variável ou etapa'],
  'why.scan': ['What happened in this scan?', 'Que s’est-il passé dans ce cycle ?', 'O que aconteceu neste ciclo?'],
  'why.none': ['Run the chart, and ask then.', 'Exécutez le grafcet, puis demandez.', 'Execute o grafcet, e depois pergunte.'],
  'why.about': [
    'Ask about a variable or a step, or choose a symbol of the drawing and “Why” in its menu. The answer goes back to what began it.',
    'Demandez pour une variable ou une étape, ou choisissez un symbole du dessin et « Pourquoi » dans son menu. La réponse remonte à ce qui a tout commencé.',
    'Pergunte por uma variável ou uma etapa, ou escolha um símbolo do desenho e «Porquê» no seu menu. A resposta recua até ao que começou tudo.',
  ],
  'why.busy': ['The run is gone through…', 'L’exécution est parcourue…', 'A execução está a ser percorrida…'],
  'why.changed': [
    'The text is no longer that of this run. Start the run again, and ask then.',
    'Le texte n’est plus celui de cette exécution. Relancez-la, puis demandez.',
    'O texto já não é o desta execução. Inicie-a de novo, e depois pergunte.',
  ],
  'why.goTo': ['Go to {at}', 'Aller à {at}', 'Ir para {at}'],
} as const satisfies Words;
