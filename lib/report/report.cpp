// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/report.h"

#include "base/atomic_file.h"
#include "report/gallery.h"
#include "report/page.h"
#include "report/view.h"

namespace ada {

void write_report(const Diagnosis &diagnosis, const Capture &capture, const std::string &path) {
  AtomicFile file(path); // a path that cannot be written is better known before the work
  const View view = make_view(diagnosis, capture);
  Gallery gallery;
  const std::string text = page(diagnosis, capture, view, gallery);
  file.write(gallery.place(text));
  file.commit();
}

} // namespace ada
