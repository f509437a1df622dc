import type { Words } from '../i18n';

export const gone = {
  'gone.now': ['No connection to the server.', 'Pas de connexion au serveur.', 'Sem ligação ao servidor.'],
  'gone.kept': [
    'No connection to the server. Your work is kept in this browser until it is back.',
    "Pas de connexion au serveur. Votre travail est gardé dans ce navigateur jusqu'à son retour.",
    'Sem ligação ao servidor. O seu trabalho fica guardado neste navegador até ele voltar.',
  ],
  'gone.full': [
    'No connection to the server, and this browser keeps no copy: download your work before you close the page.',
    'Pas de connexion au serveur, et ce navigateur ne garde pas de copie : téléchargez votre travail avant de fermer la page.',
    'Sem ligação ao servidor, e este navegador não guarda cópias: descarregue o seu trabalho antes de fechar a página.',
  ],
  'gone.strange': [
    'The server that is there now does not know this page. Open the address that it printed. Your work is kept in this browser.',
    "Le serveur présent ne connaît pas cette page. Ouvrez l'adresse qu'il a affichée. Votre travail est gardé dans ce navigateur.",
    'O servidor que está agora presente não conhece esta página. Abra o endereço que ele mostrou. O seu trabalho fica guardado neste navegador.',
  ],
  'gone.other': [
    'Another folder is served here now. Your work is kept in this browser until its own folder is back.',
    "Un autre dossier est servi ici. Votre travail est gardé dans ce navigateur jusqu'au retour de son dossier.",
    'Aqui é servida agora outra pasta. O seu trabalho fica guardado neste navegador até a sua pasta voltar.',
  ],
  'gone.newer': [
    'The server is back in another version: load the page again. Your work is kept in this browser.',
    'Le serveur est de retour dans une autre version : rechargez la page. Votre travail est gardé dans ce navigateur.',
    'O servidor voltou noutra versão: recarregue a página. O seu trabalho fica guardado neste navegador.',
  ],
  'gone.load': ['Load the page again', 'Recharger la page', 'Recarregar a página'],
  'gone.later': ['To be saved then: {names}.', 'À enregistrer alors : {names}.', 'A guardar então: {names}.'],
  'gone.waits': [
    'No connection to the server: {name} will be saved when it is back.',
    'Pas de connexion au serveur : {name} sera enregistré à son retour.',
    'Sem ligação ao servidor: {name} será guardado quando ele voltar.',
  ],
  'gone.part': [
    'This part of the page comes from the server, and there is no connection to it.',
    "Cette partie de la page vient du serveur, et il n'y a pas de connexion.",
    'Esta parte da página vem do servidor, e não há ligação.',
  ],
  'gone.back': ['The server is back.', 'Le serveur est de retour.', 'O servidor voltou.'],
  'gone.run': [
    'The shared run of {name} ended with the server.',
    "L'exécution partagée de {name} a pris fin avec le serveur.",
    'A execução partilhada de {name} terminou com o servidor.',
  ],
  'gone.last': ['no connection', 'pas de connexion', 'sem ligação'],
  'gone.lastHint': [
    'No connection to the server: this is what was heard last of the shared run.',
    "Pas de connexion au serveur : voici le dernier état reçu de l'exécution partagée.",
    'Sem ligação ao servidor: este é o último estado recebido da execução partilhada.',
  ],
} as const satisfies Words;
