_FILES_CLASSICLADDER
; Written for this project: old lists without numbers, a jump over a rung, a loop, a sub-routine.
_FILE-timers.csv
; Timers :
1,2
_/FILE-timers.csv
_FILE-monostables.csv
2,3
_/FILE-monostables.csv
_FILE-arithmetic_expressions.csv
@200/0@:=@200/0@+1
@200/0@<4
@200/0@=0
@200/2@=@200/2@+10
@200/3@:=MAXI(@200/2@,-5)-@260/0@
@260/0@:=7
_/FILE-arithmetic_expressions.csv
_FILE-rung_0.csv
#VER=2.0
#LABEL=
#COMMENT=
#PREVRUNG=-1
#NEXTRUNG=1
#NBRLINES=8
9-0-0/0 , 99-0-0/0 , 99-0-0/0 , 60-0-0/2
_/FILE-rung_0.csv
_FILE-rung_1.csv
#VER=2.0
#LABEL=
#COMMENT=
#PREVRUNG=0
#NEXTRUNG=2
#NBRLINES=8
9-0-0/0 , 99-0-0/0 , 99-0-0/0 , 60-0-0/0
99-0-0/0 , 99-0-0/0 , 20-0-0/1 , 54-0-0/1
_/FILE-rung_1.csv
_FILE-rung_2.csv
#VER=2.0
#LABEL=
#COMMENT=
#PREVRUNG=1
#NEXTRUNG=3
#NBRLINES=8
1-0-50/0 , 9-0-0/0 , 9-0-0/0 , 54-0-0/4
_/FILE-rung_2.csv
_FILE-rung_3.csv
#VER=2.0
#LABEL=
#COMMENT=
#PREVRUNG=2
#NEXTRUNG=4
#NBRLINES=8
9-0-0/0 , 99-0-0/0 , 99-0-0/0 , 60-0-0/3
_/FILE-rung_3.csv
_FILE-rung_4.csv
#VER=2.0
#LABEL=
#COMMENT=
#PREVRUNG=3
#NEXTRUNG=-1
#NBRLINES=8
1-0-50/1 , 9-0-0/0 , 9-0-0/0 , 55-0-0/5
1-0-50/2 , 99-0-0/0 , 10-0-0/0 , 50-0-60/0
0-0-0/0 , 99-1-0/0 , 99-0-0/0 , 50-0-60/2
1-0-50/3 , 99-0-0/0 , 11-0-0/0 , 50-0-60/1
_/FILE-rung_4.csv
_FILE-rung_9.csv
#VER=2.0
#LABEL=
#COMMENT=
#PREVRUNG=-1
#NEXTRUNG=-1
#NBRLINES=8
9-0-0/0 , 9-0-0/0 , 9-0-0/0 , 52-0-60/3
4-0-50/4 , 9-0-0/0 , 9-0-0/0 , 53-0-60/3
9-0-0/0 , 99-0-0/0 , 99-0-0/0 , 60-0-0/4
_/FILE-rung_9.csv
_FILE-sections.csv
#VER=1.0
#NAME000=Main
#NAME001=Chart
#NAME002=Sub
000,0,-1,0,4,0
001,1,-1,0,0,0
002,0,5,9,9,0
_/FILE-sections.csv
_FILE-sequential.csv
#VER=1.0
S0,1,0,0,1,1
S1,0,1,0,1,3
T0,1,-1,-1,-1,-1,-1,-1,-1,-1,-1,0,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,0,1,2
T1,0,-1,-1,-1,-1,-1,-1,-1,-1,-1,1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,-1,0,1,4
C0,0,60/0
C1,0,0/9
_/FILE-sequential.csv
_/FILES_CLASSICLADDER
