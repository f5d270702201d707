/* Connects the coil controller to an ATmega2560 (Arduino Mega): UART0 to the PC, UART1 to the motor
 * controllers, timer 1 for time, pin 22 for the emergency stop, the watchdog for everything else. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>

#include "coils.h"

#ifndef MOTOR_CONTROLLERS
#define MOTOR_CONTROLLERS 2 /* RoboClaws of the bench, at addresses 0x80, 0x81, ...: coils-N.hex is built with N */
#endif
#if MOTOR_CONTROLLERS < 1 || MOTOR_CONTROLLERS > 8
#error "MOTOR_CONTROLLERS must be 1 to 8: their addresses are 0x80 to 0x87"
#endif

#define BAUD 115200ul
#define UBRR_DOUBLE_SPEED ((F_CPU / 4 / BAUD - 1) / 2)

struct Ring {
  volatile uint8_t head;
  volatile uint8_t tail;
  uint8_t bytes[256]; /* indices wrap by themselves */
};

static struct Ring host_in, host_out, controllers_in, controllers_out;
static volatile uint16_t milliseconds_low;
static volatile uint16_t milliseconds_high;
static struct Coils coils;
static uint8_t reset_cause __attribute__((section(".noinit")));

/* The watchdog stays on after a reset and would strike again before main(). */
void keep_reset_cause(void) __attribute__((naked, used, section(".init3")));
void keep_reset_cause(void) {
  reset_cause = MCUSR;
  MCUSR = 0;
  wdt_disable();
}

static void put(struct Ring* ring, uint8_t byte) {
  const uint8_t next = (uint8_t)(ring->head + 1);
  if (next == ring->tail) return; /* full: the checksum shows it */
  ring->bytes[ring->head] = byte;
  ring->head = next;
}

static bool take(struct Ring* ring, uint8_t* byte) {
  if (ring->tail == ring->head) return false;
  *byte = ring->bytes[ring->tail];
  ring->tail = (uint8_t)(ring->tail + 1);
  return true;
}

ISR(USART0_RX_vect) { put(&host_in, UDR0); }
ISR(USART1_RX_vect) { put(&controllers_in, UDR1); }
ISR(USART0_UDRE_vect) {
  uint8_t byte;
  if (take(&host_out, &byte))
    UDR0 = byte;
  else
    UCSR0B &= (uint8_t)~_BV(UDRIE0);
}
ISR(USART1_UDRE_vect) {
  uint8_t byte;
  if (take(&controllers_out, &byte))
    UDR1 = byte;
  else
    UCSR1B &= (uint8_t)~_BV(UDRIE1);
}
ISR(TIMER1_COMPA_vect) {
  if (++milliseconds_low == 0) ++milliseconds_high;
}

static uint32_t now_us(void) {
  cli();
  uint16_t low = milliseconds_low;
  uint16_t high = milliseconds_high;
  const uint16_t count = TCNT1;
  if ((TIFR1 & _BV(OCF1A)) && count < 1000) { /* the timer went round, its interrupt is waiting */
    if (++low == 0) ++high;
  }
  sei();
  return ((uint32_t)high << 16 | low) * 1000ul + count / 2;
}

static void to_host(void* context, const uint8_t* bytes, uint8_t count) {
  (void)context;
  for (uint8_t i = 0; i < count; ++i) put(&host_out, bytes[i]);
  UCSR0B |= _BV(UDRIE0);
}

static void to_controllers(void* context, const uint8_t* bytes, uint8_t count) {
  (void)context;
  for (uint8_t i = 0; i < count; ++i) put(&controllers_out, bytes[i]);
  UCSR1B |= _BV(UDRIE1);
}

static void start_uarts(void) {
  UCSR0A = _BV(U2X0);
  UBRR0 = UBRR_DOUBLE_SPEED;
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
  UCSR1A = _BV(U2X1);
  UBRR1 = UBRR_DOUBLE_SPEED;
  UCSR1C = _BV(UCSZ11) | _BV(UCSZ10);
  UCSR1B = _BV(RXEN1) | _BV(TXEN1) | _BV(RXCIE1);
}

static void start_timer(void) { /* 2 MHz, 1 kHz interrupts */
  TCCR1B = 0;                   /* whatever a bootloader has left: a count beyond the top would run on to 65535 */
  TCCR1A = 0;
  OCR1A = 1999;
  TCNT1 = 0;
  TIFR1 = _BV(OCF1A);
  TCCR1B = _BV(WGM12) | _BV(CS11);
  TIMSK1 = _BV(OCIE1A);
}

int main(void) {
  DDRA &= (uint8_t)~_BV(PA0);
  PORTA |= _BV(PA0); /* Arduino pin 22, pulled up: a switch that opens, or a broken wire, stops */
  DDRA |= _BV(PA1); /* pin 23: the contactor in the supply of the coils; low, as after a reset, opens it */
  start_uarts();
  start_timer();
  const struct CoilsOutput output = {0, to_host, to_controllers};
  coils_init(&coils, output, MOTOR_CONTROLLERS, reset_cause, (reset_cause & _BV(WDRF)) != 0);
  set_sleep_mode(SLEEP_MODE_IDLE);
  wdt_enable(WDTO_250MS);
  sei();
  for (;;) {
    wdt_reset();
    uint8_t byte;
    coils_tick(&coils, now_us(), (PINA & _BV(PA0)) != 0);
    if (coils_contactor(&coils))
      PORTA |= _BV(PA1);
    else
      PORTA &= (uint8_t)~_BV(PA1);
    while (take(&host_in, &byte)) coils_host_byte(&coils, byte);
    while (take(&controllers_in, &byte)) coils_controller_byte(&coils, byte);
    /* Sleep until the next interrupt, at most a millisecond away; a byte may come just before. */
    cli();
    if (host_in.head == host_in.tail && controllers_in.head == controllers_in.tail) {
      sleep_enable();
      sei();
      sleep_cpu();
      sleep_disable();
    }
    sei();
  }
}
