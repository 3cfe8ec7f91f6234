#!/usr/bin/env python3
"""Compares results as CSV with the same as JSON Lines: csv_same.py RESULTS.jsonl RESULTS.csv.

Prints the number of lines, and whether each row of CSV holds the values of its line of JSON in their order, and no other.
"""
import csv
import json
import sys


def leaves(value):
    if isinstance(value, (list, dict)):
        items = value.values() if isinstance(value, dict) else value
        return [leaf for item in items for leaf in leaves(item)]
    return [] if value == "" else [value]


def read(field):
    try:
        return float(field)
    except ValueError:
        return field


rows = list(csv.reader(open(sys.argv[2], newline="")))
lines = [json.loads(line) for line in open(sys.argv[1])]
same = [[read(field) for field in row if field] == leaves(line) and len(row) == len(rows[0]) for row, line in zip(rows[1:], lines)]
print(len(rows) - 1, len(lines) == len(rows) - 1 and all(same))
