import type { Words } from '../i18n';

export const out = {
  'out.title': ['Export', 'Exporter', 'Exportar'],
  'out.form': ['As', 'En', 'Como'],
  'out.chart': ['Charts of other tools', "Grafcets d'autres outils", 'Grafcets de outras ferramentas'],
  'out.code': ['Code for controllers', 'Code pour automates', 'Código para autómatos'],
  'out.picture': ['Pictures', 'Images', 'Imagens'],
  'out.download': ['Download', 'Télécharger', 'Descarregar'],
  'out.copy': ['Copy', 'Copier', 'Copiar'],
  'out.copied': ['Copied.', 'Copié.', 'Copiado.'],
  'out.lossy': ['This does not mean the same as the chart', "Ceci n'a pas le même sens que le grafcet", 'Isto não significa o mesmo que o grafcet'],
  'out.differs': ['Carried with differences', 'Repris avec des différences', 'Transportado com diferenças'],
  'out.preview': ['Preview of {name}', 'Aperçu de {name}', 'Pré-visualização de {name}'],
  'out.files': ['Files', 'Fichiers', 'Ficheiros'],
} as const satisfies Words;
