"""Parts of the commands of advice_test.py, and volumes that come out of several."""

CAMERA = "--intrinsics 60,60,31.5,23.5"
POSE = "0,0,0.95,0,0,0,1"
ASK = f"vpm-query --tool small.vpmg --pose {POSE}"
TOOL = "vpm-query --tool small.vpmg --cloud wall.vpmc"
STEPS = f"vpm-query --tool small.vpmg {CAMERA} --quiet"
COUPLED = "vpm-query --tool small.vpmg --cloud wall.vpmc --poses device.txt --stiffness 2e4"
BRICK = 0.008  # m^3, the small cube
WALL = "what the small cube has behind the wall"  # stands for the volume that the sound image gives
POINTS = "the same, of points without a camera"
ROUGH = 0.1  # relative, where a new surface or coarser depths change the answer
