/* Makes the body of a message from its list of fields: WIRE_BODY(Name, name, FIELDS), where FIELDS(ONE, MANY)
 * holds ONE(type, name) and MANY(type, name, how many) in the order of the wire, of the types u8, u16, i16
 * and u32. */
#ifndef LODESTONE_COILS_WIRE_BODY_H
#define LODESTONE_COILS_WIRE_BODY_H

#include "framing.h"

#define WIRE_TYPE_u8 uint8_t
#define WIRE_TYPE_u16 uint16_t
#define WIRE_TYPE_i16 int16_t
#define WIRE_TYPE_u32 uint32_t
#define WIRE_BYTES_u8 1
#define WIRE_BYTES_u16 2
#define WIRE_BYTES_i16 2
#define WIRE_BYTES_u32 4
#define WIRE_MEMBER(type, name) WIRE_TYPE_##type name;
#define WIRE_MEMBERS(type, name, count) WIRE_TYPE_##type name[count];
#define WIRE_SIZE(type, name) +WIRE_BYTES_##type
#define WIRE_SIZES(type, name, count) +(count)*WIRE_BYTES_##type
#define WIRE_PUT(type, name) at = put_##type(at, from->name);
#define WIRE_PUTS(type, name, count) \
  for (uint8_t i = 0; i < (count); ++i) at = put_##type(at, from->name[i]);
#define WIRE_GET(type, name) \
  to->name = get_##type(at); \
  at += WIRE_BYTES_##type;
#define WIRE_GETS(type, name, count) \
  for (uint8_t i = 0; i < (count); ++i, at += WIRE_BYTES_##type) to->name[i] = get_##type(at);

/* The struct, kNameSize in bytes, put_name and get_name, which return the place behind the body. */
#define WIRE_BODY(Name, name, FIELDS)                                           \
  struct Name {                                                                 \
    FIELDS(WIRE_MEMBER, WIRE_MEMBERS)                                           \
  };                                                                            \
  enum { k##Name##Size = 0 FIELDS(WIRE_SIZE, WIRE_SIZES) };                     \
  static inline uint8_t* put_##name(uint8_t* at, const struct Name* from) {     \
    FIELDS(WIRE_PUT, WIRE_PUTS)                                                 \
    return at;                                                                  \
  }                                                                             \
  static inline const uint8_t* get_##name(const uint8_t* at, struct Name* to) { \
    FIELDS(WIRE_GET, WIRE_GETS)                                                 \
    return at;                                                                  \
  }

#endif
