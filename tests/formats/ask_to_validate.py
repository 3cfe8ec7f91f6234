#!/usr/bin/python3 -IS
"""Does what validate_json.py does, by asking the one that serves at the socket $VALIDATION_SOCKET: that has loaded its library, which
takes longer than a check."""
import os
import socket
import sys

server = socket.socket(socket.AF_UNIX)
server.connect(os.environ["VALIDATION_SOCKET"])
socket.send_fds(server, ["\0".join(sys.argv[1:]).encode()], [0, 1, 2, os.open(".", os.O_RDONLY)])
sys.exit(server.recv(1)[0])
