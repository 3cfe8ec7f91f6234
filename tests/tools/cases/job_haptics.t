# A haptics engineer's job from an empty folder, by what the pages of the programs and of libvpm/haptics tell: the example of that page,
# then a live loop, which the installation brings as an example.

# A cube of 0.1 m, and a camera's wall at 1 m.
$ printf '%s\n' OFF '8 6 0' '-1 -1 -1' '1 -1 -1' '1 1 -1' '-1 1 -1' '-1 -1 1' '1 -1 1' '1 1 1' '-1 1 1' '4 3 2 1 0' '4 4 5 6 7' '4 0 1 5 4' '4 1 2 6 5' '4 2 3 7 6' '4 3 0 4 7' > cube.off
$ vpm-pack cube.off --scale 0.05 -o cube.vpmp --spheres 1000 --quiet && vpm-graph cube.vpmp -o cube.vpmg --quiet
$ (echo P2 64 48 65535; printf '1000 %.0s' $(seq 3072)) > wall.pgm && vpm-normals wall.pgm -o wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet

# The hand rests 9 mm beyond the place where the cube touches; the page says how deep the cube is then, and what the hand feels: 3 mm, 3 N.
$ printf '%s\n' '0 0 0 0.95 0 0 0 1' '0.2 0 0 0.959 0 0 0 1' '1.5 0 0 0.959 0 0 0 1' > hand.txt
$ vpm-query --tool cube.vpmg --cloud wall.vpmc --poses hand.txt --coupling stiffness=500,damping=5 --stiffness 1e5 -o felt.jsonl
2> vpm-query: note: coupling: mass 0.0125 kg, radius of gyration 0.0408 m; to be passive a device that renders this needs a damping of its own of 5.25 N s/m
$ tail -n 1 felt.jsonl | python3 -c 'import json; s = json.loads(input()); print(round(1000 * (s["tool"][2] - 0.95), 1), "mm,", round(-s["rendered_force"][2], 1), "N")'
3.0 mm, 3.0 N

# The live loop, against what is installed and nothing else.
$ cmake --install $(dirname $(dirname $(command -v vpm-query))) --prefix P > /dev/null && c++ -std=c++20 P/share/doc/vpm/examples/consumer/control_loop.cpp $(PKG_CONFIG_PATH=P/lib/pkgconfig pkg-config --cflags --libs vpm) -Wl,-rpath,$PWD/P/lib -o loop && ./loop cube.vpmg
1000 steps of * us: at most * % of the tool inside, * N felt (glob)
