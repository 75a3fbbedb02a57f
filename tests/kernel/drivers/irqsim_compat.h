/* SPDX-License-Identifier: GPL-2.0 */
/* SPDX-FileCopyrightText: The libada4571 authors */
/* irq_to_desc() is not exported to modules; the same descriptor by a way that is. */
#include <linux/irq.h>
#include <linux/irqdesc.h>

#define irq_to_desc(irq) irq_data_to_desc(irq_get_irq_data(irq))
