# Recordings of ROS 2 in MCAP, read as they are.

$ cp $SOURCE/tests/tools/inputs/cube.off .
$ vpm-pack cube.off -o cube.vpmp --spheres 100 --quiet && vpm-graph cube.vpmp -o cube.vpmg --levels 30 --quiet
$ cat > record.sh <<< 'python3 $SOURCE/tests/tools/mcap_writer.py "$@"'
$ cat > fractions.py <<< 'import itertools, json, sys; print([round(v, 2) for v, _ in itertools.groupby(json.loads(l)["volume_fraction"] for l in sys.stdin)])'
$ printf '%s\n' '1000 0 0 0.95 0 0 0 1' '1000.1 0 0 0.95 0 0 0 1' > still.txt

# The same wall as in a folder of images, whatever it is recorded as, by poses of a file, of a topic, and of TF.
$ python3 $SOURCE/tests/tools/frames.py timed tum 3; vpm-query --tool cube.vpmg --intrinsics 60,60,31.5,23.5 --frames tum --poses still.txt --quiet | python3 fractions.py
[0.25, 0.3, 0.35]
$ for o in pad=0 pad=10 big_endian=1 encoding=32FC1 per_chunk=1 per_chunk=0 index=0 'big_endian=1 encoding=32FC1 pad=3' 'order=> compression=lz4' 'compression=zstd per_chunk=2' encoding=png binned=1; do bash record.sh rec.mcap 3 $o; vpm-query --tool cube.vpmg --frames rec.mcap --poses still.txt --quiet | python3 fractions.py; done
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
[0.25, 0.3, 0.35]
$ bash record.sh rec.mcap 3 tool=/tool; vpm-query --tool cube.vpmg --frames rec.mcap --poses rec.mcap:/tool --quiet | python3 fractions.py
[0.25, 0.3]
$ bash record.sh tf.mcap 3 tf=base:link; vpm-query --tool cube.vpmg --frames tf.mcap --poses tf.mcap:tool0 --rate 30 --quiet | sed -n 31,40p | python3 fractions.py
[0.25, 0.3, 0.35]
2> vpm-query: warning: 30 steps came before the first frame that can be used: nothing is in their way

# Two cameras of one recording are one scene; a camera that is given twice is that camera.
$ t=/camera/depth/image_rect_raw; bash record.sh rec.mcap 3; vpm-query --tool cube.vpmg --frames rec.mcap --frames rec.mcap --topic $t --topic $t --poses still.txt --quiet | python3 fractions.py
[0.25, 0.3, 0.35]
$ vpm-query --tool cube.vpmg --frames rec.mcap --frames rec.mcap --topic /camera/depth/image_rect_raw --poses still.txt
2> vpm-query: error: give --topic once for each --frames, in their order, or not at all
[2]

# An image becomes a cloud: the first, or the one of a time; or all of them.
$ bash record.sh rec.mcap 3; for at in '' '--at +0.034' '--at 1000.0666'; do vpm-normals rec.mcap -o a.vpmc $at --verbose --force 2>&1 | grep -o "is read, of.*\|image of .*\|depth [0-9.]* to [0-9.]* m"; done
image of 1000.000000000 s is read, of 3
depth 1 to 1 m
image of 1000.033333000 s is read, of 3
depth 0.99 to 0.99 m
image of 1000.066667000 s is read, of 3
depth 0.98 to 0.98 m
$ vpm-normals rec.mcap -o clouds/ --quiet && ls clouds
1000.000000000.vpmc
1000.033333000.vpmc
1000.066667000.vpmc
depth.txt

# What is truncated is read as far as it goes, which is said wherever it ends.
$ bash record.sh rec.mcap 2 per_chunk=1; for n in $(seq 9 331 $(($(stat -c %s rec.mcap) - 60))); do head -c $n rec.mcap > cut.mcap; vpm-normals cut.mcap -o cut.vpmc --force 2> said.txt; s=$?; test $s -le 1 && grep -q "it has no end, as where its recorder was stopped" said.txt || echo "$n bytes: $s"; done; head -c 9000 rec.mcap > cut.mcap; vpm-normals cut.mcap -o cut.vpmc --force
2> vpm-normals: note: intrinsics 60,60,31.5,23.5 are read from /camera/depth/camera_info in cut.mcap
2> vpm-normals: warning: cut.mcap: it has no end, as where its recorder was stopped: it is read as far as it goes, 9000 of 9000 bytes
2> vpm-normals: note: cut.mcap: its only topic of depth images is /camera/depth/image_rect_raw
2> vpm-normals: note: the camera does not move: cut.mcap has no poses of it, and no --camera-poses are given
2> vpm-normals: note: the image of 1000.000000000 s is read, of 1
$ python3 -c 'b = bytearray(open("rec.mcap", "rb").read()); b[7000] ^= 1; open("bad.mcap", "wb").write(b)'; vpm-normals bad.mcap -o bad.vpmc
2> vpm-normals: note: intrinsics 60,60,31.5,23.5 are read from /camera/depth/camera_info in bad.mcap
2> vpm-normals: warning: bad.mcap: chunks or records that are damaged, or contradict others, and are left out with all that they hold: 1
2> vpm-normals: note: bad.mcap: its only topic of depth images is /camera/depth/image_rect_raw
2> vpm-normals: note: the camera does not move: bad.mcap has no poses of it, and no --camera-poses are given
2> vpm-normals: note: the image of 1000.000000000 s is read, of 2

# Refusals say what there is.
$ bash record.sh rec.mcap 3 color=1; vpm-normals rec.mcap -o x.vpmc --topic /other; vpm-normals rec.mcap -o x.vpmc --topic /camera/color/image_raw; vpm-normals rec.mcap -o x.vpmc --at 12; vpm-normals rec.mcap -o x.vpmc --at noon; vpm-normals rec.mcap -o clouds_2/ --at +0
2> vpm-normals: error: rec.mcap: no topic /other in it; give --topic /camera/depth/image_rect_raw
2> vpm-normals: error: rec.mcap: its topic /camera/color/image_raw is sensor_msgs/msg/Image of rgb8, and none of depth images (16UC1, 32FC1 or compressedDepth of PNG); give --topic /camera/depth/image_rect_raw
2> vpm-normals: note: intrinsics 60,60,31.5,23.5 are read from /camera/depth/camera_info in rec.mcap
2> vpm-normals: note: rec.mcap: its only topic of depth images is /camera/depth/image_rect_raw
2> vpm-normals: note: the camera does not move: rec.mcap has no poses of it, and no --camera-poses are given
2> vpm-normals: error: rec.mcap: no image at 12.000 s: they are from 1000.000 to 1000.067 s; give --at +0 for the first, or a time among them
2> vpm-normals: note: intrinsics 60,60,31.5,23.5 are read from /camera/depth/camera_info in rec.mcap
2> vpm-normals: note: rec.mcap: its only topic of depth images is /camera/depth/image_rect_raw
2> vpm-normals: note: the camera does not move: rec.mcap has no poses of it, and no --camera-poses are given
2> vpm-normals: error: --at noon: give seconds, such as 12.5, or +12.5 after the first image
2> vpm-normals: error: --at is for one frame: leave it out, or name a file by --output
[2]
$ bash record.sh no_info.mcap 3 info=; vpm-normals no_info.mcap -o x.vpmc; vpm-normals a.vpmc -o x.vpmc --at 1; vpm-normals - -o x.vpmc < rec.mcap
2> vpm-normals: error: no_info.mcap: no /camera/depth/camera_info beside its images, /camera/depth/image_rect_raw; give --intrinsics fx,fy,cx,cy of its camera
2> vpm-normals: error: --at is for a recording in MCAP: leave it out
2> vpm-normals: error: standard input: this is an MCAP recording; give its file to vpm-normals, or to vpm-query --frames
[1]
$ vpm-query --tool cube.vpmg --frames tum --topic /a --poses still.txt --intrinsics 60,60,31.5,23.5; vpm-query --tool cube.vpmg --frames tf.mcap --poses tf.mcap:gripper; vpm-query --tool cube.vpmg --frames tf.mcap --poses tf.mcap:nowhere:tool0; vpm-query --tool cube.vpmg --frames tf.mcap --poses tf.mcap
2> vpm-query: error: tum: --topic is for recordings in MCAP: leave it out
2> vpm-query: error: tf.mcap: TF does not tell the pose of the frame gripper; it has poses of camera_depth_optical_frame, link, tool0; name frames that it connects, or give the poses in a file
2> vpm-query: error: tf.mcap: TF does not tell the pose of the frame tool0 in nowhere; it has poses of camera_depth_optical_frame, link, tool0; name frames that it connects, or give the poses in a file
2> vpm-query: error: tf.mcap: no topic of poses (PoseStamped; of TF: FILE:FRAME) in it; it has /camera/depth/camera_info (CameraInfo), /camera/depth/image_rect_raw (Image), /tf (TFMessage), /tf_static (TFMessage)
[1]
$ vpm-query --tool cube.vpmg --tool cube.vpmg --frames tf.mcap --poses tf.mcap:base:tool0 --poses tf.mcap:link:tool0
2> vpm-query: error: tf.mcap:link:tool0: the paths of the tools are in two frames, base and link; name the poses of one world: FILE:WORLD:FRAME
[1]

# Other recordings are named with the command that converts them.
$ printf '#ROSBAG V2.0\n' > a.bag; mkdir bag2; printf 'SQLite format 3\0' > bag2/a_0.db3; for o in '--frames a.bag --poses still.txt' '--frames bag2 --poses still.txt' '--frames tum --poses a.bag' '--frames tum --poses bag2/a_0.db3'; do vpm-query --tool cube.vpmg --intrinsics 60,60,31.5,23.5 $o; done
2> vpm-query: error: a.bag: this is a ROS bag; convert it to MCAP: rosbags-convert --src BAG --dst OUT --dst-storage mcap
2> vpm-query: error: bag2: no frames in it, but a recording of ROS, a_0.db3; convert it to MCAP: rosbags-convert --src bag2 --dst OUT --dst-storage mcap
2> vpm-query: error: a.bag: this is a ROS bag; convert it to MCAP: rosbags-convert --src BAG --dst OUT --dst-storage mcap
2> vpm-query: error: bag2/a_0.db3: this is a database of SQLite, such as a bag of ROS 2; convert the bag's folder to MCAP: rosbags-convert --src FOLDER --dst OUT --dst-storage mcap
[1]
