// SPDX-License-Identifier: Apache-2.0
// shaders/page_write.layout.h: push constants and bindings of page_write.comp, which writes entries of a page table.
#ifndef PALPATE_PAGE_WRITE_LAYOUT_H
#define PALPATE_PAGE_WRITE_LAYOUT_H
#include "brick_pool.layout.h"

#define PAGE_WRITE_GROUP 64u
#define PAGE_WRITE_BINDING_LIST 0
#define PAGE_WRITE_BINDING_PAGES 1
#define PAGE_WRITE_BINDINGS 2

PALPATE_LAYOUT_BEGIN

struct PageWrite {
  uint brick;  // linear page index
  uint slot;
  float constant;
};

struct PageWritePush {
  uint first, count;
};

PALPATE_LAYOUT_CHECK(PageWrite, 12)
PALPATE_PUSH_CHECK(PageWritePush)

PALPATE_LAYOUT_END
#endif
