# Behaviour that all tools share.

$ vpm-probe --version
vpm-probe 0.1.0

$ vpm-probe
2> vpm-probe: error: input is required (see vpm-probe --help)
[2]

$ vpm-probe in.off -o - --flag --levels 1,2,3
in.off none 3 0.100000 [1,2,3] flag

# The configuration of a call gives the same call again.
$ vpm-probe in.off -o out.txt --text 1e5 --factor 1e-9 --levels 10,20 --flag --threads 2 --dump-config | tee call.json
{
  "act": "nothing",
  "count": 3,
  "device": "auto",
  "factor": 1e-09,
  "flag": true,
  "input": "in.off",
  "levels": [
    10,
    20
  ],
  "output": "out.txt",
  "text": "1e5",
  "threads": 2
}
$ vpm-probe --config call.json --dump-config | cmp - call.json
$ vpm-probe --config - --dump-config < call.json | cmp - call.json
$ vpm-probe --config call.json && cat out.txt
in.off 1e5 3 0.000000 [10,20] flag
$ vpm-probe --config call.json --count 7 -o -
in.off 1e5 7 0.000000 [10,20] flag

# A configuration can be written before the inputs are known.
$ vpm-probe --dump-config
{
  "act": "nothing",
  "count": 3,
  "device": "auto",
  "factor": 0.1,
  "text": "none",
  "threads": 0
}
$ vpm-probe --dump-config > defaults.json && vpm-probe --config defaults.json in.off -o -
in.off none 3 0.100000 []

# Wrong configurations are refused.
$ echo '{"threadz": 2}' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: there is no option 'threadz'; is 'threads' meant? (see vpm-probe --help)
[2]
$ echo '{"help": true}' | vpm-probe --config - in.off -o -
2> vpm-probe: error: help: This option is not allowed in a configuration file (see vpm-probe --help)
[2]
$ echo '{"count": {"a": 1}}' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: the configuration's 'count' must be a number, a string, true, false or a list of these (see vpm-probe --help)
[2]
$ echo '[1]' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: the configuration must be a JSON object of options (see vpm-probe --help)
[2]
$ echo '{' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: the configuration is not JSON: it cannot be read from line 2 on (see vpm-probe --help)
[2]
$ vpm-probe --config missing.json in.off -o -
2> vpm-probe: error: --config: cannot read missing.json: No such file or directory (see vpm-probe --help)
[2]
$ echo '{"count": 5, "flag": true, "count": 6}' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: the configuration is ambiguous: it gives "count" twice; leave one of them out (see vpm-probe --help)
[2]
$ echo '{"flag": false, "count": 5}' | vpm-probe --config - in.off -o -
in.off none 5 0.100000 []
$ echo '{"count": "five"}' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: --count five: give a whole number (see vpm-probe --help)
[2]
$ echo '{"count": 3}' | vpm-probe --config - --count five in.off -o -
2> vpm-probe: error: --count five: give a whole number (see vpm-probe --help)
[2]

# No text of a configuration may end early for the system, and none is read without end.
$ echo '{"output": "out.txt\u0000.vpmp"}' | vpm-probe --config - in.off
2> vpm-probe: error: --config standard input: the configuration's 'output' has a character of code 0 in it (see vpm-probe --help)
[2]
$ echo '{"out\u0000put": "out.txt"}' | vpm-probe --config - in.off
2> vpm-probe: error: --config standard input: a name in the configuration has a character of code 0 in it (see vpm-probe --help)
[2]
$ (echo '['; yes '"a",') | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: the configuration is longer than 1000000 bytes (see vpm-probe --help)
[2]

# Flags take no value on the command line, and true or false in a configuration.
$ vpm-probe in.off -o - --flag=1e999
2> vpm-probe: error: --flag takes no value; leave out =1e999
[2]
$ vpm-probe in.off -o - --flag=true
2> vpm-probe: error: --flag takes no value; leave out =true
[2]
$ vpm-probe --version=2
2> vpm-probe: error: --version takes no value; leave out =2
[2]
$ echo '{"flag": 2}' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: --flag: give true or false (see vpm-probe --help)
[2]
$ echo '{"flag": "maybe"}' | vpm-probe --config - in.off -o -
2> vpm-probe: error: --config standard input: --flag maybe: give true or false (see vpm-probe --help)
[2]

# Each kind of error has its exit code.
$ vpm-probe in.off -o - --act refuse
2> vpm-probe: error: input.off: refused as asked
[1]
$ vpm-probe in.off -o - --act usage
2> vpm-probe: error: wrong as asked
[2]
$ vpm-probe in.off -o - --act unavailable
2> vpm-probe: error: not there as asked
[3]
$ vpm-probe in.off -o - --act throw
2> vpm-probe: error: thrown as asked
[1]
$ vpm-probe in.off -o - --act exhaust
2> vpm-probe: error: not enough memory for this input
[1]
$ vpm-probe in.off -o - --wrong
2> vpm-probe: error: The following argument was not expected: --wrong (see vpm-probe --help)
[2]
$ vpm-probe in.off -o - --coutn 5
2> vpm-probe: error: there is no option --coutn; is --count meant? (see vpm-probe --help)
[2]
$ vpm-probe in.off -o - --count many
2> vpm-probe: error: --count many: give a whole number (see vpm-probe --help)
[2]
$ vpm-probe in.off -o - --threads -1
2> vpm-probe: error: --threads: -1 is not a whole number from 0 to 4096 (see vpm-probe --help)
[2]
$ vpm-probe in.off -o - --device tpu
2> vpm-probe: error: --device: tpu not in {auto,cpu,cuda,cuda:N,cuda:all} (see vpm-probe --help)
[2]
# The reason why there is no device depends on the build and the machine.
$ vpm-probe in.off -o - --device cuda:999 2>&1 | sed 's/cuda:999: .*;/cuda:999: WHY;/'
vpm-probe: error: --device cuda:999: WHY; use --device cpu, or leave the option out
[3]
$ vpm-probe in.off -o - --device cuda:all 2>&1 | sed 's/cuda:all: .*;/cuda:all: WHY;/'
vpm-probe: error: --device cuda:all: WHY; use --device cpu, or leave the option out
[3]
$ vpm-probe in.off -o missing/out.txt
2> vpm-probe: error: cannot write missing/out.txt: there is no folder missing
[4]
$ vpm-probe in.off -o .
2> vpm-probe: error: . is a folder; name a file
[4]
$ vpm-probe in.off -o /dev/full
2> vpm-probe: error: cannot write /dev/full: No space left on device
[4]
$ vpm-probe in.off -o - > /dev/full
2> vpm-probe: error: cannot write to standard output: No space left on device
[4]
$ vpm-probe --dump-config > /dev/full
2> vpm-probe: error: cannot write to standard output
[4]

# Messages appear, and no progress, if there is no terminal.
$ vpm-probe in.off -o /dev/null --act say
2> vpm-probe: note: a note
2> vpm-probe: warning: a warning
$ vpm-probe in.off -o /dev/null --act say --quiet
2> vpm-probe: warning: a warning
$ vpm-probe in.off -o /dev/null --act say --verbose
2> vpm-probe: note: a note
2> vpm-probe: warning: a warning
2> vpm-probe: a detail

# Provenance names no files and no option that changes no result.
$ vpm-probe in.off -o out.txt --force --act parameters --threads 2 --levels 4 --flag
{"act":"parameters","count":3,"factor":0.1,"flag":true,"levels":4,"text":"none"}

# Nothing is replaced without --force.
$ vpm-probe in.off -o out.txt
2> vpm-probe: error: out.txt exists; name another output, or give --force to overwrite it
[2]
$ vpm-probe in.off -o out.txt --force
$ printf '\x89VPM\r\n\x1a\n\x01\0\0\0\x03\0\0\0' > frame.vpmc && vpm-probe in.off -o frame.vpmc
2> vpm-probe: error: frame.vpmc exists and is a cloud (.vpmc); name another output, or give --force to overwrite it
[2]
$ vpm-probe in.off -o frame.vpmc --force && cat frame.vpmc
in.off none 3 0.100000 []

# Outputs may be links, pipes and devices.
$ ln -s out.txt link && vpm-probe in.off -o link --force --text through && readlink link && cat out.txt
out.txt
in.off through 3 0.100000 []
$ vpm-probe in.off -o /dev/stdout
in.off none 3 0.100000 []
$ vpm-probe in.off -o >(cat) | cat
in.off none 3 0.100000 []
$ umask 027 && vpm-probe in.off -o private.txt && stat -c %a private.txt
640
$ ls -A
call.json
defaults.json
frame.vpmc
link
out.txt
private.txt
