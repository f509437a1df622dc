// Two tokens of .g7 that no regular expression can tell: block notes, `/* … */` and `(* … *)`, which may be
// nested, and the `(` of a call, which stands on the line of the name before it.

#include "tree_sitter/parser.h"

enum TokenType { BLOCK_NOTE, CALL_OPEN };

void *tree_sitter_g7_external_scanner_create(void) { return NULL; }
void tree_sitter_g7_external_scanner_destroy(void *payload) { (void)payload; }
unsigned tree_sitter_g7_external_scanner_serialize(void *payload, char *buffer) {
  (void)payload;
  (void)buffer;
  return 0;
}
void tree_sitter_g7_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
  (void)payload;
  (void)buffer;
  (void)length;
}

static bool is_blank(int32_t c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == 0xFEFF; }

bool tree_sitter_g7_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid) {
  (void)payload;
  bool same_line = true;
  while (is_blank(lexer->lookahead)) {
    same_line = same_line && lexer->lookahead != '\n';
    lexer->advance(lexer, true);
  }
  int32_t open = lexer->lookahead;
  int32_t close = open == '(' ? ')' : '/';
  if (open != '(' && open != '/') return false;
  lexer->advance(lexer, false);
  if (lexer->lookahead != '*') {
    if (open != '(' || !valid[CALL_OPEN] || !same_line) return false;
    lexer->result_symbol = CALL_OPEN;
    return true;
  }
  if (!valid[BLOCK_NOTE]) return false;
  lexer->advance(lexer, false);
  for (unsigned depth = 1; depth > 0;) {
    if (lexer->eof(lexer)) return false;
    int32_t c = lexer->lookahead;
    lexer->advance(lexer, false);
    if (c == '*' && lexer->lookahead == close) {
      lexer->advance(lexer, false);
      depth--;
    } else if (c == open && lexer->lookahead == '*') {
      lexer->advance(lexer, false);
      depth++;
    }
  }
  lexer->result_symbol = BLOCK_NOTE;
  return true;
}
