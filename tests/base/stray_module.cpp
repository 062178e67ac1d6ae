// SPDX-License-Identifier: Apache-2.0
// A shared library that is no module of Palpate: without a version, or with that of another.
#ifdef STRAY_VERSION
extern "C" {
extern const char palpate_module_version[];
const char palpate_module_version[] = STRAY_VERSION;
}
#endif
extern "C" const int palpate_stray = 0;
