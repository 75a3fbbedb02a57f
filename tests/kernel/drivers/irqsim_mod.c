// SPDX-License-Identifier: GPL-2.0
// SPDX-FileCopyrightText: The libada4571 authors
/* Makes a module of the kernel's own irq_sim.c. */
#include <linux/module.h>

MODULE_DESCRIPTION("Simulated interrupts for gpio-sim");
MODULE_LICENSE("GPL");
