/* SPDX-License-Identifier: MIT
 * SPDX-FileCopyrightText: The libada4571 authors
 *
 * The public header alone, first and twice, as strict C99; and a C program that links. */
#include "ada4571.h"
#include "ada4571.h"

#include <string.h>

int main(void) {
  ada4571_source_options options;
  ada4571_source_options_init(&options);
  return options.struct_size == sizeof options && strcmp(ada4571_version(), "") != 0 ? 0 : 1;
}
