#!/bin/sh
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: The libada4571 authors
#
# The program that the README shows is the one that is built: readme.sh README EXAMPLE
set -eu
shown=$(sed -n '/^```c$/,/^```$/{/^```/d;p}' "$1")
built=$(sed -n '/^#include/,$p' "$2")
[ -n "$shown" ] && [ "$shown" = "$built" ]
