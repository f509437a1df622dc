import type { Words } from '../i18n';

/** The words of links that carry a file, and of charts in other pages. */
export const share = {
  'share.title': ['Share by link', 'Partager par lien', 'Partilhar por ligação'],
  'share.about': [
    'The link carries the whole file behind its #. No server keeps it, and whoever opens the link has a copy.',
    "Le lien porte le fichier entier derrière son #. Aucun serveur ne le garde, et qui ouvre le lien en a une copie.",
    'A ligação leva o ficheiro inteiro depois do #. Nenhum servidor o guarda, e quem abre a ligação fica com uma cópia.',
  ],
  'share.link': ['Link', 'Lien', 'Ligação'],
  'share.copy': ['Copy the link', 'Copier le lien', 'Copiar a ligação'],
  'share.length': ['{n} characters', '{n} caractères', '{n} caracteres'],
  'share.long': [
    '{n} characters: some programs cut links of more than {most}. A file in a mail is safer.',
    "{n} caractères : certains programmes coupent les liens de plus de {most}. Un fichier joint est plus sûr.",
    '{n} caracteres: alguns programas cortam ligações com mais de {most}. Um ficheiro anexado é mais seguro.',
  ],
  'share.uses': ['With it go: {names}.', 'Avec lui : {names}.', 'Com ele vão: {names}.'],
  'share.place': ['Address of the page that opens it', "Adresse de la page qui l'ouvre", 'Endereço da página que a abre'],
  'share.own': [
    'This is the address of your own server. For others, give that of a page of G7 that they can reach.',
    "C'est l'adresse de votre propre serveur. Pour d'autres personnes, donnez celle d'une page de G7 qu'elles peuvent atteindre.",
    'Este é o endereço do seu próprio servidor. Para outras pessoas, indique o de uma página do G7 a que possam aceder.',
  ],
  'share.bad': [
    'This is no address of a page: it begins with http:// or https://.',
    "Ce n'est pas l'adresse d'une page : elle commence par http:// ou https://.",
    'Isto não é o endereço de uma página: começa por http:// ou https://.',
  ],
  'share.qr': ['QR code of the link', 'Code QR du lien', 'Código QR da ligação'],
  'share.qrSave': ['Download the QR code', 'Télécharger le code QR', 'Descarregar o código QR'],
  'share.noQr': ['The link is too long for a QR code ({n} characters, {most} at most).', 'Le lien est trop long pour un code QR ({n} caractères, {most} au plus).', 'A ligação é longa demais para um código QR ({n} caracteres, {most} no máximo).'],
  'share.embed': ['In another page', 'Dans une autre page', 'Noutra página'],
  'share.embedAbout': [
    'The chart as it runs, in a page of yours: its readers can run and change it.',
    "Le grafcet tel qu'il tourne, dans une de vos pages : vos lecteurs peuvent le faire tourner et le modifier.",
    'O grafcet a correr, numa página sua: os leitores podem pô-lo a correr e mudá-lo.',
  ],
  'share.frame': ['As a frame', 'Comme cadre', 'Como moldura'],
  'share.element': ['As an element with its text', 'Comme élément avec son texte', 'Como elemento com o seu texto'],
  'share.copyFrame': ['Copy the frame', 'Copier le cadre', 'Copiar a moldura'],
  'share.copyElement': ['Copy the element', "Copier l'élément", 'Copiar o elemento'],
  'share.noFrames': [
    'The server on your machine is shown in no other page. Give the address of a playground above.',
    "Le serveur de votre machine n'est montré dans aucune autre page. Donnez ci-dessus l'adresse d'un site de G7.",
    'O servidor da sua máquina não é mostrado noutras páginas. Indique acima o endereço de um sítio do G7.',
  ],
  'share.tooLarge': [
    'The file is too large for a link. Save it and send it as a file.',
    'Le fichier est trop grand pour un lien. Enregistrez-le et envoyez-le comme fichier.',
    'O ficheiro é grande demais para uma ligação. Guarde-o e envie-o como ficheiro.',
  ],
  'share.copied': ['Copied.', 'Copié.', 'Copiado.'],
  'share.cut': [
    'The link is not whole: a part of it was cut off or changed. Ask for it again, or for the file.',
    "Le lien n'est pas entier : une partie a été coupée ou changée. Redemandez-le, ou demandez le fichier.",
    'A ligação não está inteira: uma parte foi cortada ou mudada. Peça-a de novo, ou peça o ficheiro.',
  ],
  'share.later': [
    'A later version of G7 made this link. Open it in a page of that version, or ask for the file.',
    'Une version plus récente de G7 a fait ce lien. Ouvrez-le dans une page de cette version, ou demandez le fichier.',
    'Uma versão mais recente do G7 fez esta ligação. Abra-a numa página dessa versão, ou peça o ficheiro.',
  ],
  'share.large': [
    'The files of this link are too large for the page.',
    'Les fichiers de ce lien sont trop grands pour la page.',
    'Os ficheiros desta ligação são grandes demais para a página.',
  ],
  'share.open': ['Open in G7', 'Ouvrir dans G7', 'Abrir no G7'],
  'share.nothing': ['This frame holds no chart.', 'Ce cadre ne contient pas de grafcet.', 'Esta moldura não contém nenhum grafcet.'],
  'share.unread': ['The chart of {address} cannot be read.', "Le grafcet de {address} ne peut pas être lu.", 'O grafcet de {address} não pode ser lido.'],
} as const satisfies Words;
