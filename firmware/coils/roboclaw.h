/* RoboClaw packet serial, the part that the coil controller needs. Numbers on that wire are big-endian. */
#ifndef LODESTONE_COILS_ROBOCLAW_H
#define LODESTONE_COILS_ROBOCLAW_H

#include <stdint.h>

enum RoboClawCommand {
  kSetSerialTimeout = 14, /* u8, 100 ms: the controller stops its motors when nobody talks to it */
  kReadSerialTimeout = 15,
  kReadMainBattery = 24, /* u16, 0.1 V */
  kDriveDuty = 34,       /* i16, i16: +-32767 of the supply */
  kReadCurrents = 49,    /* i16, i16, 10 mA */
  kSetDutyRampM1 = 68,   /* u32, duty counts per second */
  kSetDutyRampM2 = 69,
  kReadTemperature = 82,  /* u16, 0.1 C */
  kReadStatus = 90,       /* u32 */
  kSetMaxCurrentM1 = 133, /* u32, u32, 10 mA */
  kSetMaxCurrentM2 = 134,
};

enum {
  kRoboClawAddress = 0x80, /* of the first controller; the second is the next, up to 0x87 */
  kRoboClawAcknowledged = 0xff,
  kRoboClawMaxRequest = 12,
  kRoboClawMaxReply = 6,
  kRoboClawFullDuty = 32767,
};
#define ROBOCLAW_FASTEST_RAMP 655359ul

/* Status bits that make a pulse unsafe: emergency stop, temperatures, over-current errors and warnings. */
#define ROBOCLAW_STATUS_FAULTS 0x00033007ul

static inline uint16_t roboclaw_crc(uint16_t crc, uint8_t byte) {
  crc ^= (uint16_t)((uint16_t)byte << 8);
  for (uint8_t bit = 0; bit < 8; ++bit) crc = (uint16_t)(crc & 0x8000 ? (crc << 1) ^ 0x1021 : crc << 1);
  return crc;
}

#endif
