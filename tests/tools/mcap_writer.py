"""Writes recordings of ROS 2 in MCAP by hand: records, chunks, checksums, and messages in CDR.

As a program it records the wall of frames.py, which comes 10 mm nearer with each image: mcap_writer.py FILE COUNT [NAME=VALUE...],
with 30 images a second from 1000 s on, and the names of Recording.
"""
import ctypes
import struct
import sys
import zlib

import frames

MAGIC = b"\x89MCAP0\r\n"
IMAGE, COMPRESSED, CAMERA_INFO = (f"sensor_msgs/msg/{name}" for name in ("Image", "CompressedImage", "CameraInfo"))
POSE, TF = "geometry_msgs/msg/PoseStamped", "tf2_msgs/msg/TFMessage"
STILL = (0, 0, 0, 0, 0, 0, 1)


def text(value):
    """Returns a text of MCAP."""
    return struct.pack("<I", len(value)) + value.encode()


def record(kind, data):
    return struct.pack("<BQ", kind, len(data)) + data


class Cdr:
    """A message in the making; numbers are aligned to their size."""

    def __init__(self, order="<"):
        self.order, self.bytes = order, b""

    def add(self, form, *values):
        for value in values:
            size = struct.calcsize(form)
            self.bytes += bytes(-len(self.bytes) % size) + struct.pack(self.order + form, value)
        return self

    def text(self, value):
        self.add("I", len(value) + 1)
        self.bytes += value.encode() + b"\0"
        return self

    def header(self, time, frame):
        """Takes the time in seconds, with nine digits at most."""
        return self.add("i", int(time)).add("I", round((time - int(time)) * 1e9)).text(frame)

    def data(self, data):
        self.add("I", len(data))
        self.bytes += data
        return self

    def message(self):
        return (b"\0\1\0\0" if self.order == "<" else b"\0\0\0\0") + self.bytes


def image(time, frame, width, height, encoding, rows, step, big_endian=0, order="<"):
    return Cdr(order).header(time, frame).add("I", height, width).text(encoding).add("B", big_endian).add("I", step).data(rows).message()


def compressed(time, frame, form, data, order="<"):
    return Cdr(order).header(time, frame).text(form).data(data).message()


def camera_info(time, frame, size, k, d=(), p=None, binning=(0, 0), roi=(0, 0, 0, 0), order="<"):
    """Takes width and height; fx, fy, cx, cy of K and of P; x, y, height and width of the region of interest."""
    fx, fy, cx, cy = k
    px, py, qx, qy = p or k
    cdr = Cdr(order).header(time, frame).add("I", size[1], size[0]).text("plumb_bob").add("I", len(d)).add("d", *d)
    cdr.add("d", fx, 0, cx, 0, fy, cy, 0, 0, 1, *(1, 0, 0, 0, 1, 0, 0, 0, 1), px, 0, qx, 0, 0, py, qy, 0, 0, 0, 1, 0)
    return cdr.add("I", *binning, *roi).add("B", 0).message()


def pose(time, frame, numbers, order="<"):
    return Cdr(order).header(time, frame).add("d", *numbers).message()


def transforms(*told, order="<"):
    """Takes time, frame, child and seven numbers of each."""
    cdr = Cdr(order).add("I", len(told))
    for time, frame, child, numbers in told:
        cdr.header(time, frame).text(child).add("d", *numbers)
    return cdr.message()


def compress(name, data):
    """Returns the data as a frame of LZ4 or zstd, by the libraries that the programs load, too."""
    if not name:
        return data
    library = ctypes.CDLL({"lz4": "liblz4.so.1", "zstd": "libzstd.so.1"}[name])
    bound, compressor = {"lz4": ("LZ4F_compressFrameBound", "LZ4F_compressFrame"), "zstd": ("ZSTD_compressBound", "ZSTD_compress")}[name]
    for function in (bound, compressor):
        getattr(library, function).restype = ctypes.c_size_t
    size = getattr(library, bound)(ctypes.c_size_t(len(data)), None)
    out = ctypes.create_string_buffer(size)
    last = (None,) if name == "lz4" else (3,)  # preferences; level
    size = getattr(library, compressor)(out, ctypes.c_size_t(size), data, ctypes.c_size_t(len(data)), *last)
    return out.raw[:size]


class Writer:
    """A file of chunks of `per_chunk` messages, or of none where that is 0."""

    def __init__(self, per_chunk=4, index=True, compression=""):
        self.start = MAGIC + record(1, text("ros2") + text("by hand"))
        self.per_chunk, self.index, self.compression = per_chunk, index, compression
        self.body, self.pending, self.waiting, self.channels, self.indexes = b"", b"", 0, {}, b""

    def add(self, topic, kind, message, time, encoding="cdr"):
        """Adds a message that was recorded at a time, s."""
        if (topic, kind) not in self.channels:
            number = self.channels[topic, kind] = len(self.channels) + 1
            self.pending += record(3, struct.pack("<H", number) + text(kind) + text("ros2msg") + text(""))
            self.pending += record(4, struct.pack("<HH", number, number) + text(topic) + text(encoding) + text(""))
        stamp = round(time * 1e9)
        self.pending += record(5, struct.pack("<HIQQ", self.channels[topic, kind], 0, stamp, stamp) + message)
        self.waiting += 1
        if self.waiting >= self.per_chunk:
            self.flush()

    def flush(self):
        if self.per_chunk and self.waiting:
            size, stored = len(self.pending), compress(self.compression, self.pending)
            self.indexes += record(8, struct.pack("<QQQQ", 0, 0, len(self.start + self.body), size))
            self.pending = record(6, struct.pack("<QQQI", 0, 0, size, zlib.crc32(self.pending)) + text(self.compression)
                                  + struct.pack("<Q", len(stored)) + stored)
        self.body, self.pending, self.waiting = self.body + self.pending, b"", 0

    def bytes(self):
        self.flush()
        summary = self.indexes if self.index else b""
        body = self.start + self.body + record(15, bytes(4))
        return body + summary + record(2, struct.pack("<QQI", len(body) if summary else 0, 0, 0)) + MAGIC


class Recording:
    """What is recorded of the wall; each may be given by name on the command line."""
    topic, frame = "/camera/depth/image_rect_raw", "camera_depth_optical_frame"
    encoding, big_endian, pad, info = "16UC1", 0, 0, "/camera/depth/camera_info"  # or the encoding png: a compressedDepth
    binned = 0  # whether camera_info is that of the whole sensor, of which the image is a part, binned 2 x 2
    order = "<"  # of the bytes of CDR
    per_chunk, index, compression = 4, 1, ""
    tool, tf, color = "", "", 0  # a topic of poses; frames "WORLD:PARENT"; whether a second topic has colours


def image_of_wall(depth, time, options):
    """Returns the type and message of an image."""
    width, height, encoding = frames.WIDTH, frames.HEIGHT, options.encoding
    if encoding == "png":
        return COMPRESSED, compressed(time, options.frame, "16UC1; compressedDepth png", bytes(12) + frames.png(depth), options.order)
    form = (">" if int(options.big_endian) else "<") + ("f" if encoding == "32FC1" else "H")
    row = struct.pack(form, depth / 1000 if encoding == "32FC1" else depth) * width + bytes(int(options.pad))
    return IMAGE, image(time, options.frame, width, height, encoding, row * height, len(row), int(options.big_endian), options.order)


def messages_of_wall(count, options):
    """Yields topic, type, message and time of recording."""
    start, order = 1000, options.order
    if options.tf:
        world, parent = options.tf.split(":")
        yield "/tf_static", TF, transforms((0, parent, options.frame, STILL), order=order), start
        for time in (999, 1010):
            yield "/tf", TF, transforms((time, world, parent, STILL), (time, world, "tool0", (0, 0, 0.95, 0, 0, 0, 1)), order=order), time
    for k in range(count):
        time = round(start + k / 30, 6)
        whole = {"size": (160, 120), "k": (120, 120, 73.5, 57.5), "binning": (2, 2), "roi": (10, 10, 96, 128)}
        seen = {"size": (frames.WIDTH, frames.HEIGHT), "k": (60, 60, 31.5, 23.5)}
        if options.info:
            yield options.info, CAMERA_INFO, camera_info(time, options.frame, order=order, **whole if int(options.binned) else seen), time
        yield options.topic, *image_of_wall(1000 - 10 * k, time, options), time
        if int(options.color):
            yield "/camera/color/image_raw", IMAGE, image(time, "color", 2, 1, "rgb8", bytes(6), 6), time
        if options.tool:
            yield options.tool, POSE, pose(time, options.frame, (0, 0, 0.95, 0, 0, 0, 1), order), time


def write(messages, options):
    writer = Writer(int(options.per_chunk), int(options.index), options.compression)
    for message in messages:
        writer.add(*message)
    return writer.bytes()


if __name__ == "__main__":
    wanted = Recording()
    for argument in sys.argv[3:]:
        name, value = argument.split("=", 1)
        if not hasattr(wanted, name):
            sys.exit(f"Recording has no {name}")
        setattr(wanted, name, value)
    with open(sys.argv[1], "wb") as file:
        file.write(write(messages_of_wall(int(sys.argv[2]), wanted), wanted))
