// SPDX-License-Identifier: Apache-2.0
// shaders/page_write.comp: writes entries of a page table, one per invocation.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "page_write.layout.h"

layout(local_size_x = PAGE_WRITE_GROUP) in;
layout(push_constant) uniform Push { PageWritePush push; };
layout(std430, binding = PAGE_WRITE_BINDING_LIST) readonly buffer List { PageWrite list[]; };
layout(std430, binding = PAGE_WRITE_BINDING_PAGES) writeonly buffer Pages { BrickPage pages[]; };

void main() {
  const uint n = (gl_WorkGroupID.y * GROUPS_PER_ROW + gl_WorkGroupID.x) * PAGE_WRITE_GROUP + gl_LocalInvocationID.x;
  if (n >= push.count) return;
  const PageWrite write = list[push.first + n];
  pages[write.brick] = BrickPage(write.slot, write.constant);
}
