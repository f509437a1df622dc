" Vim syntax file
" Language: GRAFCET and SFC charts in the .g7 language
" Generated from the table of words of G7 by `make grammars`; do not edit.

if exists('b:current_syntax')
  finish
endif

let s:save = &cpo
set cpo&vim
syntax case match

syntax keyword g7Reserved BY CASE DO ELSE ELSIF END_CASE END_FOR END_IF END_REPEAT END_WHILE
syntax keyword g7Reserved EXIT FOR IF OF REPEAT RETURN THEN TO UNTIL WHILE
syntax keyword g7Reserved action by case chart const do else elsif enclosing end_case
syntax keyword g7Reserved end_for end_if end_repeat end_while exit for function if initial input
syntax keyword g7Reserved layout macro macrochart of output plant priority profile prove repeat
syntax keyword g7Reserved return step task then to transition until var when while
syntax keyword g7WordOperator AND MOD NOT OR XOR and mod not or xor
syntax keyword g7Edge delay fall rise
syntax keyword g7Boolean FALSE TRUE false true
syntax keyword g7Type LDATE_AND_TIME DATE_AND_TIME LTIME_OF_DAY TIME_OF_DAY F_TRIG R_TRIG STRING ARRAY DWORD LDATE
syntax keyword g7Type LREAL LTIME LWORD UDINT ULINT USINT BOOL BYTE CTUD DATE
syntax keyword g7Type DINT LINT LTOD REAL SINT TIME UINT WORD CTD CTU
syntax keyword g7Type INT LDT TOD TOF TON DT RS SR TP
syntax keyword g7Profile iec60848 iec61131 jgrafchart pl7 unity
syntax keyword g7Profile tsx3710 tsx3720 tsx57
syntax match g7Profile /\<\%(parallel-actions\|ordered-actions\|keep-step-time\|zero-step-time\|no-final-scan\|simultaneous\|single-token\|multi-token\|pulse-first\|final-scan\|scan-clock\|sequential\|text-order\|time-clock\|one-pass\|stable\|bound\)\>/
syntax match g7Function /\<\%(ABS\|ACOS\|ADD\|AND\|ASIN\|ATAN\|CONCAT\|CONCAT_DATE_TOD\|COS\|DAY_OF_WEEK\|DELETE\|DIV\|EQ\|EXP\|EXPT\|FIND\|GE\|GT\|INSERT\|LE\|LEFT\|LEN\|LIMIT\|LN\|LOG\|LT\|MAX\|MID\|MIN\|MOD\|MOVE\|MUL\|MUX\|NE\|NOT\|OR\|REPLACE\|RIGHT\|ROL\|ROR\|SEL\|SHL\|SHR\|SIN\|SQRT\|SUB\|TAN\|TRUNC\|XOR\)\>\ze\s*(/
syntax match g7Clause /\%(\S\s\+\)\@40<=\<\%(INIT\|after\|always\|as\|at\|between\|block\|bound\|clearing\|cold\|every\|expect\|fault\|il\|in\|inverted\|ld\|leads\|length\|max\|most\|never\|on\|reachable\|retain\|safe\|scan\|section\|seed\|st\|with\|within\)\>\%(\s*\%(:=\|->\|=>\|[,.:]\)\)\@!/
syntax match g7Clause /\%(\%(pre\|post\|each\)\s\+\)\@20<=\%(st\|il\|ld\|scan\)\>/
syntax match g7Qualifier /\<\%(DS\|P0\|P1\|SD\|SL\|D\|L\|N\|P\|R\|S\)\>\ze\s\+[A-Za-z0-9_`%({]/
syntax match g7Statement /\%(\%(^\|[{};]\)\s*\)\@80<=\<\%(actions\|always\|arrivals\|assume\|call\|comment\|drive\|each\|enable\|enclose\|entry\|expect\|force\|instance\|link\|mask\|on\|parts\|post\|pre\|pulse\|rate\|release\|restart\|scan\|set\|sheet\|state\|struct\|target\|test\|type\|use\|view\|wait\)\>\%(\s*\%(:=\|->\|=>\|[,.:]\)\)\@!/

syntax match g7Operator /:=\|=>\|<>\|<=\|>=\|!=\|==\|\*\*\|[=<>≠≤≥+*&·!↑↓^]\|\/\%([\/*]\)\@!/
syntax match g7Arrow /->\|→/
syntax match g7Number /\<\d[0-9_]*\%(\.\d[0-9_]*\)\?\%([eE][+-]\?\d\+\)\?\>/
syntax match g7Number /\<\%(\d\+\|[A-Z]\+\)#[+-]\?[0-9A-Za-z_.]\+/
syntax match g7Duration /\<\d[0-9_]*\%(\.\d[0-9_]*\)\?\%(d\|h\|ms\|us\|ns\|m\|s\)[0-9a-z_.]*\>/
syntax match g7Duration /\c\<l\?t\%(ime\)\?#[+-]\?\d[0-9a-z_.]*/
syntax match g7Duration /\c\<l\?\%(d\|date\|dt\|date_and_time\)#\d\+-\d\+-\d\+\%(-\d\+:[0-9:]\+\%(\.\d\+\)\?\)\?/
syntax match g7Duration /\c\<l\?\%(tod\|time_of_day\)#\d\+:[0-9:]\+\%(\.\d\+\)\?/
syntax match g7Direct /%\a\w*\%(\.\w\+\)*\%(:[Xx]\d\+\)\?/
syntax match g7Member /\.\@1<=\w\+/ contained
syntax match g7Path /\%(\w\|`\)\@1<=\.\w\+/ contains=g7Member
syntax match g7Complement /[A-Za-z0-9_)\]`]\@1<='\+/
syntax region g7String start=/[A-Za-z0-9_)\]`']\@1<!'/ skip=/\$./ end=/'\|$/ oneline
syntax region g7Comment start=/"/ skip=/\\./ end=/"\|$/ oneline
syntax region g7Quoted start=/`/ skip=/\\./ end=/`\|$/ oneline
syntax match g7Note /\/\/.*$/ contains=@Spell
syntax region g7Note start=/\/\*/ end=/\*\// contains=g7Note,@Spell fold
syntax region g7Note start=/(\*/ end=/\*)/ contains=g7Note,@Spell fold
syntax region g7Block start=/{/ end=/}/ transparent fold
syntax sync minlines=200

highlight default link g7Reserved Keyword
highlight default link g7Statement Keyword
highlight default link g7Clause Keyword
highlight default link g7WordOperator Operator
highlight default link g7Edge Operator
highlight default link g7Boolean Boolean
highlight default link g7Qualifier StorageClass
highlight default link g7Type Type
highlight default link g7Function Function
highlight default link g7Profile Constant
highlight default link g7Operator Operator
highlight default link g7Arrow Operator
highlight default link g7Complement Operator
highlight default link g7Number Number
highlight default link g7Duration Number
highlight default link g7Direct Identifier
highlight default link g7Member Identifier
highlight default link g7Quoted Identifier
highlight default link g7String String
highlight default link g7Comment String
highlight default link g7Note Comment

let b:current_syntax = 'g7'
let &cpo = s:save
unlet s:save
