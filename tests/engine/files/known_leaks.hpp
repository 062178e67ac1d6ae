// SPDX-License-Identifier: Apache-2.0
// Tells the leak sanitizer which leaks are the libraries' own. They occur when a library refuses a damaged file: file
// names in NIfTI's, the whole image in NRRD's, the nodes read so far in OpenVDB. Without the sanitizer nobody calls
// this function. Include it in one source file of a test.
#pragma once

// NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the sanitizer looks for this name
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libITKniftiio\nleak:libITKNrrdIO\nleak:inflateInit2_\nleak:readTopology\nleak:readBuffers\n";
}
