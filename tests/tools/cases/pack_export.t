# vpm-pack --export: other programs read each format.

$ printf 'OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n' > cube.off
$ for f in csv json ply points.ply vtk; do vpm-pack cube.off --spheres 9 --export all.$f || echo $f; done
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
$ for f in yaml urdf srdf; do vpm-pack cube.off --spheres 9 --link 'left "hand"' --export all.$f || echo $f; done
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
2> vpm-pack: note: 9 spheres fill 60.4 % of a solid of 1 x 1 x 1 m
$ python3 -c 'import json; p = json.load(open("all.json")); print(len(p["centers"]), len(p["radii"]), round(p["radii"][0], 9), [round(c, 9) for c in p["centers"][0]])'
9 9 0.5 [0.5, 0.5, 0.5]
$ python3 -c 'import xml.etree.ElementTree as t; r = t.parse("all.urdf").getroot(); c = r.findall("link/collision"); print(r.find("link").get("name"), len(c), c[0].find("origin").get("xyz"), c[0].find("geometry/sphere").get("radius"))'
left "hand" 9 0.5 0.5 0.5 0.5
$ python3 -c 'import xml.etree.ElementTree as t; r = t.parse("all.srdf").getroot(); a = r.find("link_sphere_approximation"); print(a.get("link"), len(a), a[0].get("center"), a[0].get("radius"))'
left "hand" 9 0.5 0.5 0.5 0.5
$ head -3 all.yaml
collision_spheres:
  "left \"hand\"":
    - "center": [0.5, 0.5, 0.5]
$ head -c 3 all.ply; grep -ac 'property float radius' all.points.ply; sed -n 5p all.vtk
ply1
POINTS 9 double
# A parser of XML reads the same name back, whatever is in it; what XML cannot express is refused.
$ python3 -c 'import subprocess as s, xml.etree.ElementTree as t; names = ["a\tb", " a\n\r\nb ", "<&>\"\x27]]>", "\u00e4\u20ac\U0001F600", "&amp;&#9;"]; run = lambda n, f: s.run(["vpm-pack", "cube.off", "--spheres", "2", "--quiet", "--link", n, "--force", "--export", "x." + f], check=True); print([n for n in names for f, e, k in (("urdf", "link", "name"), ("srdf", "link_sphere_approximation", "link")) if run(n, f) and t.parse("x." + f).getroot().find(e).get(k) != n])'
[]
$ vpm-pack cube.off --link "$(printf 'a\001')" --export control.urdf
2> vpm-pack: error: link: the name 'a\x01' has a character that XML cannot express; give another name
[2]
# The packing does not depend on the name of the link.
$ vpm-pack cube.off --spheres 9 -o - --quiet --link a --export a.urdf | cmp - <(vpm-pack cube.off --spheres 9 -o - --quiet)
