"""Writes poses.jsonl, whose lines have "pose", in other forms, each to a file of its name; those of bad-* end in a pose that is refused."""

import json
import struct

poses = [json.loads(line)['pose'] for line in open('poses.jsonl')]
lines = [json.dumps(pose) + '\n' for pose in poses]
words = [' '.join(map(str, pose)) + '\n' for pose in poses]


def write(name, parts):
    with open(name, 'w', newline='') as file:
        file.write(''.join(parts))


def write_array(name, poses):
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({len(poses)}, 7), }}".ljust(117) + '\n'
    with open(name, 'wb') as file:
        file.write(b'\x93NUMPY\x01\x00' + struct.pack('<H', len(header)) + header.encode())
        file.write(b''.join(struct.pack('<7d', *pose) for pose in poses))


write('windows', [line.replace('\n', '\r\n') for line in lines])
write('over-lines', lines[:60] + ['\n'] + ['{\n"pose":' + line + '}\n' for line in lines[60:65]] + lines[65:])
write('list', lines[:50] + ['[' + ','.join(lines[50:90]).replace('\n', '') + ']\n'] + lines[90:-1] + [lines[-1][:-1]])
write('words', ['# tx ty tz qx qy qz qw\n'] + words[:70] + ['# tx ty tz qw qx qy qz\n'] + words[70:])
write('mixed', [line if k % 3 else words[k] for k, line in enumerate(lines)])
write_array('array', poses)

write('bad-list', lines[:40] + ['[[0,0,0.9,0,0,0,1],[0,0,0.9,0,0,0,0]]\n'] + lines)
write('bad-words', lines[:40] + ['0 0 0.9 0 0 0 one\n'] + lines)
write('bad-end', lines[:40] + ['[0, 0,\n'])
write_array('bad-array', poses[:90] + [[0, 0, 0.9, 0, 0, 0, 0]] + poses)
