#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# driver_test.sh fuzz_faulty CORPUS: the driver finds each kind of fault, keeps the input, and finds nothing where nothing is.
set -uo pipefail
faulty=$1 corpus=$2 wrong=0
TMPDIR=$(mktemp -d)
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
say() { echo "driver_test: $*"; wrong=1; }

PALPATE_FAULT='' "$faulty" --runs 2000 "$corpus" || say "a fault was found where there is none"
[ -z "$(ls "$TMPDIR")" ] || say "an input was kept without a fault"
for fault in crash hang other message accepted ${PALPATE_FAULT_MEMORY-memory}; do
  if PALPATE_FAULT=$fault "$faulty" --runs 2000 --seconds 1 "$corpus" >"$TMPDIR/out" 2>&1; then say "'$fault' was not found"; fi
  input=$(ls "$TMPDIR"/*.input 2>/dev/null) || { say "the input of '$fault' was not kept"; continue; }
  grep -q 1e309 "$input" || say "another input was kept for '$fault'"
  if PALPATE_FAULT=$fault "$faulty" --seconds 1 "$input" >/dev/null 2>&1; then say "the kept input does not show '$fault'"; fi
  rm -f "$TMPDIR"/*
done
printf 'no number' >"$TMPDIR/ok-wrong"
if PALPATE_FAULT='' "$faulty" "$TMPDIR/ok-wrong" 2>/dev/null; then say "an input was judged otherwise than its name says, and nobody saw it"; fi
if PALPATE_FAULT='' "$faulty" "$TMPDIR/missing" 2>/dev/null; then say "a missing input went unnoticed"; fi
exit $wrong
