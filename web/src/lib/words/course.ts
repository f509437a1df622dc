import type { Words } from '../i18n';

export const course = {
  'course.title': ['Course', 'Cours', 'Curso'],
  'course.about': [
    'Fifteen chapters, from the first step to a whole machine: each with charts to run and change, a question, and an exercise.',
    'Quinze chapitres, de la première étape à une machine entière : chacun avec des grafcets à exécuter et à modifier, une question et un exercice.',
    'Quinze capítulos, da primeira etapa a uma máquina inteira: cada um com grafcets para executar e alterar, uma pergunta e um exercício.',
  ],
  'course.begin': ['Begin the course', 'Commencer le cours', 'Começar o curso'],
  'course.goOn': ['Go on with chapter {n}', 'Continuer au chapitre {n}', 'Continuar no capítulo {n}'],
  'course.chapter': ['Chapter', 'Chapitre', 'Capítulo'],
  'course.before': ['Chapter before', 'Chapitre précédent', 'Capítulo anterior'],
  'course.next': ['Next chapter', 'Chapitre suivant', 'Capítulo seguinte'],
  'course.nextIs': ['Next chapter: {title}', 'Chapitre suivant : {title}', 'Capítulo seguinte: {title}'],
  'course.close': ['Close the course', 'Fermer le cours', 'Fechar o curso'],
  'course.question': ['Answers', 'Réponses', 'Respostas'],
  'course.answered': ['answered', 'répondu', 'respondido'],
  'course.open': ['Open in the editor', 'Ouvrir dans l’éditeur', 'Abrir no editor'],
  'course.right': ['Right', 'Juste', 'Certo'],
  'course.wrong': ['No', 'Non', 'Não'],
} as const satisfies Words;
