# A roboticist's job from an empty folder, by what the pages tell: a recording, two tools each on a path of its own, a run that is
# interrupted, and a table that says which frame each line saw.

# A cube of 0.2 m, and one of 0.1 m; a wall that comes 50 mm nearer each second.
$ printf '%s\n' OFF '8 6 0' '-1 -1 -1' '1 -1 -1' '1 1 -1' '-1 1 -1' '-1 -1 1' '1 -1 1' '1 1 1' '-1 1 1' '4 3 2 1 0' '4 4 5 6 7' '4 0 1 5 4' '4 1 2 6 5' '4 2 3 7 6' '4 3 0 4 7' > cube.off
$ for s in 0.1 0.05; do vpm-pack cube.off --scale $s --spheres 100 -o $s.vpmp --quiet && vpm-graph $s.vpmp -o $s.vpmg --quiet; done
$ for k in 0 1 2; do (echo P2 64 48 65535; yes $((1000 - 50 * k)) | head -n 3072) > frame$k.pgm; echo "$k frame$k.pgm"; done > frames.txt
$ for z in 0.9 0.94; do printf '%s\n' "0 0 0 $z 0 0 0 1" "2.9 0 0 $z 0 0 0 1" > at$z.txt; done

# Interrupted by a full disk, it goes on; the faces that look at the wall begin at 1 m and .99 m.
$ echo 'vpm-query --tool 0.1.vpmg --tool 0.05.vpmg --frames frames.txt --poses at0.9.txt --poses at0.94.txt --intrinsics 60,60,31.5,23.5 --rate 10 --quiet -o steps.csv "$@"' > ask.sh
$ (ulimit -f 4; bash ask.sh); bash ask.sh --resume && awk -F, 'NR > 1 { n[$5 " " $3]++; sum[$5 " " $3] += $7 } END { for (k in n) printf "%s %d %.2f\n", k, n[k], sum[k] / n[k] }' steps.csv | sort
frame0.pgm 0 10 0.00
frame0.pgm 1 10 0.00
frame1.pgm 0 10 0.25
frame1.pgm 1 10 0.40
frame2.pgm 0 10 0.50
frame2.pgm 1 10 0.90
2> vpm-query: error: cannot write steps.csv: File too large

# Where in the recording the large cube is hit first, for a script.
$ awk -F, 'NR > 1 && $3 == 0 && $7 > 0.01 { print $4, $5; exit }' steps.csv
1.0 frame1.pgm
