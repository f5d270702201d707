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

/* The same of a body that depends on the bench: WIRE_BENCH_BODY(Name, name, FIELDS), where FIELDS(ONE,
 * OUTPUTS, CONTROLLERS) holds ONE(type, name), OUTPUTS(type, name), a number for each output, and
 * CONTROLLERS(type, name), one for each motor controller. Its struct has room for all that there may be
 * (kMostOutputs, kMostControllers); name_size, put_name and get_name are told how many motor controllers
 * there are, and leave the rest of it alone. */
#define WIRE_MEMBER_OUTPUTS(type, name) WIRE_TYPE_##type name[kMostOutputs];
#define WIRE_MEMBER_CONTROLLERS(type, name) WIRE_TYPE_##type name[kMostControllers];
#define WIRE_SIZE_OUTPUTS(type, name) +(2 * controllers) * WIRE_BYTES_##type
#define WIRE_SIZE_CONTROLLERS(type, name) +(controllers)*WIRE_BYTES_##type
#define WIRE_PUT_OUTPUTS(type, name) WIRE_PUTS(type, name, 2 * controllers)
#define WIRE_PUT_CONTROLLERS(type, name) WIRE_PUTS(type, name, controllers)
#define WIRE_GET_OUTPUTS(type, name) WIRE_GETS(type, name, 2 * controllers)
#define WIRE_GET_CONTROLLERS(type, name) WIRE_GETS(type, name, controllers)

#define WIRE_BENCH_BODY(Name, name, FIELDS)                                                          \
  struct Name {                                                                                      \
    FIELDS(WIRE_MEMBER, WIRE_MEMBER_OUTPUTS, WIRE_MEMBER_CONTROLLERS)                                \
  };                                                                                                 \
  static inline uint8_t name##_size(uint8_t controllers) {                                           \
    return (uint8_t)(0 FIELDS(WIRE_SIZE, WIRE_SIZE_OUTPUTS, WIRE_SIZE_CONTROLLERS));                 \
  }                                                                                                  \
  static inline uint8_t* put_##name(uint8_t* at, const struct Name* from, uint8_t controllers) {     \
    FIELDS(WIRE_PUT, WIRE_PUT_OUTPUTS, WIRE_PUT_CONTROLLERS)                                         \
    return at;                                                                                       \
  }                                                                                                  \
  static inline const uint8_t* get_##name(const uint8_t* at, struct Name* to, uint8_t controllers) { \
    FIELDS(WIRE_GET, WIRE_GET_OUTPUTS, WIRE_GET_CONTROLLERS)                                         \
    return at;                                                                                       \
  }

#endif
